// freeze_thread PID NAME: stops one thread of a process, as a thread that hangs; it goes on when the standard
// input ends. Only while it waits in the kernel, so that it holds nothing that the others need. Says "frozen"
// when it is so; exit status 1 if the thread cannot be stopped.

#include <poll.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

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
    // The number of the call that it was stopped in; −1: none.
    const std::string call = first_word(tasks / std::to_string(thread) / "syscall");
    if (call != "-1" && call != "running" && !call.empty()) break;
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
