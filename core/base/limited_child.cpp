#include "core/base/limited_child.hpp"

#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <optional>
#include <utility>

#include "core/base/contract.hpp"
#include "core/base/sanitized.hpp"
#include "core/base/wording.hpp"

namespace stickslip::base {
namespace {

constexpr int kOutOfMemory = 99;  ///< Exit status.
constexpr std::uint64_t kBytesInMB = 1'000'000;

struct QuestionHead {
  std::uint64_t size = 0;
  std::int64_t processor_time_ms = 0;
  std::uint64_t memory = 0;
};

bool send_all(int socket, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = ::send(socket, at, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, void* data, std::size_t size) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::recv(socket, at, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool send_text(int socket, std::string_view text) {
  const std::uint64_t size = text.size();
  return send_all(socket, &size, sizeof size) && send_all(socket, text.data(), text.size());
}

/// \return nullopt if the child is gone. Errors: kUsage if its text is longer than kLongestAnswer.
Result<std::optional<std::string>> receive_text(int socket) {
  std::uint64_t size = 0;
  if (!receive_all(socket, &size, sizeof size)) return std::nullopt;
  if (size > kLongestAnswer) {
    return usage_error("cannot be read: its reader's answer has {} bytes, at most {} are taken", size,
                       kLongestAnswer);
  }
  std::string text(size, '\0');
  if (!receive_all(socket, text.data(), text.size())) return std::nullopt;
  return text;
}

/// Of this process, 0 where the system does not say.
std::uint64_t mapped_bytes() {
  std::uint64_t pages = 0;
  std::ifstream{"/proc/self/statm"} >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// The limits of the child, from within: a child that answers many questions has as many allowances.
class Allowance {
 public:
  Allowance() {
    sigevent event{};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGXCPU;
    if (::timer_create(CLOCK_PROCESS_CPUTIME_ID, &event, &timer_) != 0) ::_exit(1);
  }

  void grant(const QuestionHead& question) const {
    constexpr std::int64_t kMsInSecond = 1000;
    constexpr std::int64_t kNsInMs = 1'000'000;
    itimerspec time{};
    time.it_value.tv_sec = question.processor_time_ms / kMsInSecond;
    time.it_value.tv_nsec = question.processor_time_ms % kMsInSecond * kNsInMs;
    if (::timer_settime(timer_, 0, &time, nullptr) != 0) ::_exit(1);
    if (kSanitized) return;
    if (const std::uint64_t mapped = mapped_bytes(); mapped > 0) limit_memory(mapped + question.memory);
  }

  /// Between two questions.
  void end() const {
    const itimerspec never{};
    ::timer_settime(timer_, 0, &never, nullptr);
    if (!kSanitized) limit_memory(RLIM_INFINITY);
  }

 private:
  static void limit_memory(rlim_t bytes) {
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = std::min(bytes, limit.rlim_max);
    ::setrlimit(RLIMIT_AS, &limit);
  }

  timer_t timer_{};
};

[[noreturn]] void answer_from(int socket, int memory_file, const ChildWork& work) {
  // What ends it is told by the parent, in one line.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL, SIGXCPU, SIGINT, SIGTERM})
    static_cast<void>(std::signal(signal, SIG_DFL));
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  // A parent may be limited to short output. What is written here stays in memory, and has its own limit.
  rlimit files{};
  ::getrlimit(RLIMIT_FSIZE, &files);
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_FSIZE, &files);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::set_new_handler([] { ::_exit(kOutOfMemory); });
  const Allowance allowance;
  QuestionHead head;
  while (receive_all(socket, &head, sizeof head)) {
    std::string question(head.size, '\0');
    if (!receive_all(socket, question.data(), question.size())) break;
    if (::ftruncate(memory_file, 0) != 0 || ::lseek(memory_file, 0, SEEK_SET) != 0) ::_exit(1);
    allowance.grant(head);
    try {
      const std::string answer = work(question, memory_file);
      allowance.end();
      if (!send_text(socket, answer)) break;
    } catch (const std::bad_alloc&) {
      ::_exit(kOutOfMemory);
    } catch (const std::exception&) {
      ::_exit(1);
    }
  }
  ::_exit(0);
}

/// Its socket is the child's standard input, the memory file its standard output; nothing else of this
/// process stays open in it.
Result<pid_t> spawn(const ChildProgram& program, int socket, int memory_file) {
  std::string path = program.path;
  std::vector<std::string> words = program.arguments;
  std::vector<char*> arguments{path.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, memory_file, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  sigset_t none{};
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int error = posix_spawn(&child, path.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    return failure("a process to read files cannot be started ({}): {}", program.path, system_message(error));
  }
  return child;
}

}  // namespace

WorkLimits limits_for_file(std::uint64_t size) {
  constexpr std::chrono::milliseconds kLeastTime{10'000};
  constexpr std::uint64_t kBytesInMillisecond = 1000;
  constexpr std::uint64_t kLeastMemory = 512 * kBytesInMB;
  constexpr std::uint64_t kMemoryOfByte = 20;
  return {kLeastTime + std::chrono::milliseconds{static_cast<std::int64_t>(size / kBytesInMillisecond)},
          kLeastMemory + kMemoryOfByte * size};
}

void answer_questions(const ChildWork& work) { answer_from(STDIN_FILENO, STDOUT_FILENO, work); }

Result<void> LimitedChild::start() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return failure("cannot make a socket to a child process: {}", system_message(errno));
  Descriptor own{ends[0]};
  const Descriptor childs{ends[1]};
  Descriptor memory_file{::memfd_create("answer", MFD_CLOEXEC)};
  if (!memory_file.open()) return failure("no memory for a child's answer: {}", system_message(errno));
  if (const auto* const program = std::get_if<ChildProgram>(&start_)) {
    const Result<pid_t> child = spawn(*program, childs.get(), memory_file.get());
    if (!child) return tl::unexpected(child.error());
    child_ = *child;
  } else {
    std::fflush(nullptr);  // Or both would write what is buffered.
    const pid_t child = ::fork();
    if (child < 0) return failure("no child process: {}", system_message(errno));
    if (child == 0) {
      own = Descriptor{};  // Or it would never hear that this process is gone.
      answer_from(childs.get(), memory_file.get(), std::get<ChildWork>(start_));
    }
    child_ = child;
  }
  socket_ = std::move(own);
  memory_file_ = std::move(memory_file);
  return {};
}

Result<std::string> LimitedChild::ask(std::string_view question, const WorkLimits& limits,
                                      const std::function<bool()>& given_up) {
  if (auto begun = begin(question, limits); !begun) return tl::unexpected(begun.error());
  return answer(given_up);
}

Result<void> LimitedChild::begin(std::string_view question, const WorkLimits& limits) {
  const QuestionHead head{question.size(), limits.processor_time.count(), limits.memory};
  if (asked_) end();
  // One that died between two questions, by whatever hand, is no answer to this one.
  pollfd idle{socket_.get(), POLLIN, 0};
  if (child_ != 0 && ::poll(&idle, 1, 0) != 0) end();
  if (child_ == 0) {
    if (auto started = start(); !started) return tl::unexpected(started.error());
  }
  asked_ = limits;
  // If it died meanwhile, answer() finds that no answer comes.
  static_cast<void>(send_all(socket_.get(), &head, sizeof head) &&
                    send_all(socket_.get(), question.data(), question.size()));
  return {};
}

Result<std::string> LimitedChild::answer(const std::function<bool()>& given_up) {
  STICKSLIP_EXPECTS(asked_);
  const Result<bool> come = wait_for_answer(given_up);
  if (!come) {
    end();
    return tl::unexpected(come.error());
  }
  const WorkLimits limits = *std::exchange(asked_, std::nullopt);
  auto text = receive_text(socket_.get());
  if (!text) {
    end();  // What it says next would be no answer.
    text.error().worker_died = true;
    return tl::unexpected(std::move(text).error());
  }
  if (*text) return **std::move(text);
  tl::unexpected<Error> died = why_it_died(limits);
  died.value().worker_died = true;
  return died;
}

Result<bool> LimitedChild::wait_for_answer(const std::function<bool()>& given_up) const {
  constexpr int kLookAgain_ms = 100;
  for (;;) {
    pollfd answer{socket_.get(), POLLIN, 0};
    const int ready = ::poll(&answer, 1, given_up ? kLookAgain_ms : -1);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR)
      return failure("a child's answer cannot be waited for: {}", system_message(errno));
    if (given_up && given_up())
      return tl::unexpected(Error{ErrorKind::kInterrupted, "was not read to its end: told to stop"});
  }
}

tl::unexpected<Error> LimitedChild::why_it_died(const WorkLimits& limits) {
  int status = 0;
  while (::waitpid(child_, &status, 0) == -1 && errno == EINTR) {
  }
  child_ = 0;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    return usage_error("cannot be read in {} s of processor time, which is the limit for its size",
                       static_cast<double>(limits.processor_time.count()) / 1000.0);
  }
  if (WIFSIGNALED(status)) {
    return usage_error("cannot be read: its reader was ended by signal {} ({})", WTERMSIG(status),
                       ::strsignal(WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) == kOutOfMemory) {
    return usage_error("cannot be read in {} MB of memory, which is the limit for its size",
                       limits.memory / kBytesInMB);
  }
  return usage_error("cannot be read: its reader ended with status {}", WEXITSTATUS(status));
}

void LimitedChild::end() noexcept {
  asked_.reset();
  if (child_ == 0) return;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) == -1 && errno == EINTR) {
  }
  child_ = 0;
}

std::string LimitedChild::memory_file() const { return fmt::format("/proc/self/fd/{}", memory_file_.get()); }

}  // namespace stickslip::base
