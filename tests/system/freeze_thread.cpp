// freeze_thread PID NAME: stops one thread of a process, as a thread that hangs; it goes on when the standard
// input ends. Only while it waits for something to happen, so that it holds nothing that the others need: in
// other calls, such as one that wakes a thread, it may hold a lock. Says "frozen" when it is so; exit status
// 1 if the thread cannot be stopped.

#include <linux/futex.h>
#include <poll.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

std::string first_word(const std::filesystem::path& file) {
  std::string word;
  std::ifstream{file} >> word;
  return word;
}

/// In a call that waits: the first words of /proc/PID/task/TID/syscall are its number and its arguments.
bool waits(const std::filesystem::path& task) {
  std::ifstream file{task / "syscall"};
  std::string call;
  file >> call;
  if (call.empty() || call == "running" || call == "-1") return false;
  const long number = std::stol(call);
  if (number == SYS_futex) {
    std::string address;
    std::string operation;
    file >> address >> operation;
    const auto command = static_cast<int>(std::stoul(operation, nullptr, 16)) & FUTEX_CMD_MASK;
    return command == FUTEX_WAIT || command == FUTEX_WAIT_BITSET;
  }
  return number == SYS_clock_nanosleep || number == SYS_epoll_wait || number == SYS_poll ||
         number == SYS_ppoll;
}

pid_t thread_of(const std::filesystem::path& tasks, const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator{tasks}) {
    if (first_word(task.path() / "comm") == name) return std::stoi(task.path().filename());
  }
  return -1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  const std::filesystem::path tasks = std::filesystem::path{"/proc"} / arguments[1] / "task";
  const pid_t thread = thread_of(tasks, arguments[2]);
  if (thread < 0 || ::ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0) {
    std::perror(arguments[2]);
    return 1;
  }
  for (;;) {
    int status = 0;
    if (::ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0 || ::waitpid(thread, &status, __WALL) < 0) {
      std::perror(arguments[2]);
      return 1;
    }
    if (waits(tasks / std::to_string(thread))) break;
    ::ptrace(PTRACE_CONT, thread, nullptr, nullptr);
  }
  std::puts("frozen");
  std::fflush(stdout);
  // Of a process that is killed a traced thread stays until its tracer has asked for it.
  constexpr int kLook_ms = 100;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (::poll(&input, 1, kLook_ms) == 0) {
    int status = 0;
    if (::waitpid(thread, &status, WNOHANG | __WALL) != 0) return 0;
  }
  return 0;  // The kernel lets go of what is traced by a process that ends.
}
