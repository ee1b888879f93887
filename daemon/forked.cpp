#include "daemon/forked.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>

#include "core/record/file.hpp"

namespace stickslip::daemon {
namespace {

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void child(const std::function<std::string()>& work, std::chrono::seconds longest, int output) {
  const auto seconds = static_cast<rlim_t>(longest.count());
  const rlimit time{seconds, seconds + 1};
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &time);
  ::setrlimit(RLIMIT_CORE, &no_core);
  // What ends it is told by the parent, in one line.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL}) ::signal(signal, SIG_DFL);
  int status = 0;
  try {
    write_all(output, work());
  } catch (const std::exception&) {
    status = 1;
  }
  ::_exit(status);
}

}  // namespace

std::string read_to_end(int file) {
  std::string text;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t got = ::read(file, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

base::Result<ForkedAnswer> run_forked(const std::function<std::string()>& work,
                                      std::chrono::seconds longest) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    return base::failure("no pipe to a child: {}", record::system_message(errno));
  const record::Descriptor from_child{ends[0]};
  record::Descriptor to_parent{ends[1]};
  std::fflush(nullptr);  // Or both would write what is buffered.
  const pid_t pid = ::fork();
  if (pid < 0) return base::failure("no child process: {}", record::system_message(errno));
  if (pid == 0) child(work, longest, to_parent.get());
  to_parent = record::Descriptor{};
  ForkedAnswer answer{read_to_end(from_child.get()), {}};
  int status = 0;
  while (::waitpid(pid, &status, 0) == -1) {
    if (errno != EINTR)
      return base::failure("a child cannot be waited for: {}", record::system_message(errno));
  }
  if (WIFSIGNALED(status)) answer = {{}, WTERMSIG(status)};
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0) answer = {{}, 0};
  return answer;
}

}  // namespace stickslip::daemon
