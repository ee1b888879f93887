#include "io/child_process.hpp"

extern "C" {  // glibc 2.36 leaves it out.
#include <sys/pidfd.h>
}

#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

namespace stickslip::io {
namespace {

/// A file in memory. The child's input and output are such files, because pipes can fill up and deadlock both
/// sides.
record::Descriptor memory_file(const char* name) {
  return record::Descriptor{memfd_create(name, MFD_CLOEXEC)};
}

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return lseek(file, 0, SEEK_SET) == 0;
}

bool read_all(int file, std::string& text) {
  if (lseek(file, 0, SEEK_SET) != 0) return false;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t got = read(file, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) return true;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

/// Sets the child's descriptors 0, 1 and 2 and closes all others, because Asio's sockets are not closed on
/// exec.
class Redirections {
 public:
  Redirections(int input, int output, int errors) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, errors, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  ~Redirections() { posix_spawn_file_actions_destroy(&actions_); }
  Redirections(const Redirections&) = delete;
  Redirections& operator=(const Redirections&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// Restores the default action of SIGXFSZ in the child. The daemon ignores it and the child would inherit
/// that.
class LimitsEnd {
 public:
  LimitsEnd() {
    sigset_t signals{};
    sigemptyset(&signals);
    sigaddset(&signals, SIGXFSZ);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF);
  }
  ~LimitsEnd() { posix_spawnattr_destroy(&attributes_); }
  LimitsEnd(const LimitsEnd&) = delete;
  LimitsEnd& operator=(const LimitsEnd&) = delete;

  [[nodiscard]] const posix_spawnattr_t* get() const noexcept { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

/// Sets the limits of a running child, because posix_spawn cannot. The child may exceed output_size before
/// that, so wait() checks the size again.
void limit(pid_t child, const ChildLimits& limits) {
  const rlimit no_core{0, 0};
  ::prlimit(child, RLIMIT_CORE, &no_core, nullptr);
  if (limits.processor_time.count() > 0) {
    const auto seconds = static_cast<rlim_t>(limits.processor_time.count());
    const rlimit time{seconds, seconds + 1};
    ::prlimit(child, RLIMIT_CPU, &time, nullptr);
  }
  if (limits.output_size > 0) {
    // Soft: a reader of records that the child starts writes more (record::read_record_apart()).
    rlimit size{};
    ::prlimit(child, RLIMIT_FSIZE, nullptr, &size);
    size.rlim_cur = limits.output_size;
    ::prlimit(child, RLIMIT_FSIZE, &size, nullptr);
  }
  if (limits.niceness > 0) {
    constexpr int kNicest = 19;
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(child),
                  std::min(kNicest, ::getpriority(PRIO_PROCESS, 0) + limits.niceness));
  }
}

/// Waits for the end of a process. \param process  of ChildProcess::ended(); true at once if it is not open.
bool ends_within(const record::Descriptor& process, std::chrono::milliseconds longest) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point last = Clock::now() + longest;
  pollfd end{process.get(), POLLIN, 0};
  while (process.open()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(last - Clock::now());
    const int ready = ::poll(&end, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready == 0) return false;
    if (ready > 0 || errno != EINTR) return true;
  }
  return true;
}

}  // namespace

base::Result<std::optional<ChildProcess>> ChildProcess::start(const std::string& program,
                                                              std::vector<std::string> arguments,
                                                              std::string_view input_text,
                                                              const ChildLimits& limits,
                                                              std::vector<std::string> variables) {
  const record::Descriptor input = memory_file("input");
  record::Descriptor output = memory_file("output");
  record::Descriptor errors = memory_file("errors");
  if (!input.open() || !output.open() || !errors.open() || !write_all(input.get(), input_text)) {
    return base::failure("no memory to ask {}: {}", program, record::system_message(errno));
  }
  std::string name = program;
  std::vector<char*> argument_list{name.data()};
  for (std::string& argument : arguments) argument_list.push_back(argument.data());
  argument_list.push_back(nullptr);
  // Nothing of the user's: neither language nor variables that the program knows.
  variables.emplace_back("LC_ALL=C.UTF-8");
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  const Redirections redirections{input.get(), output.get(), errors.get()};
  const LimitsEnd attributes;
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, program.c_str(), redirections.get(), attributes.get(),
                                     argument_list.data(), environment.data());
      error == ENOENT) {
    return std::nullopt;
  } else if (error != 0) {
    return base::failure("{} cannot be started: {}", program, record::system_message(error));
  }
  limit(child, limits);
  return ChildProcess{program, child, std::move(output), std::move(errors), limits.output_size};
}

ChildProcess::ChildProcess(std::string program, pid_t child, record::Descriptor output,
                           record::Descriptor errors, std::size_t output_limit)
    : program_(std::move(program)),
      child_(child),
      output_(std::move(output)),
      errors_(std::move(errors)),
      output_limit_(output_limit) {}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : program_(std::move(other.program_)),
      child_(std::exchange(other.child_, 0)),
      output_(std::move(other.output_)),
      errors_(std::move(other.errors_)),
      output_limit_(other.output_limit_) {}

ChildProcess::~ChildProcess() {
  if (child_ == 0) return;
  end();
  while (waitpid(child_, nullptr, 0) == -1 && errno == EINTR) {
  }
}

record::Descriptor ChildProcess::ended() const { return record::Descriptor{pidfd_open(child_, 0)}; }

void ChildProcess::end() noexcept { ::kill(child_, SIGKILL); }

base::Result<ChildAnswer> ChildProcess::wait() {
  int status = 0;
  while (waitpid(child_, &status, 0) == -1) {
    if (errno != EINTR)
      return base::failure("{} cannot be waited for: {}", program_, record::system_message(errno));
  }
  child_ = 0;
  constexpr int kSignalled = 128;  // As shells count.
  ChildAnswer answer;
  answer.status = WIFSIGNALED(status) ? kSignalled + WTERMSIG(status) : WEXITSTATUS(status);
  struct stat written {};
  if (output_limit_ > 0 && fstat(output_.get(), &written) == 0 &&
      static_cast<std::size_t>(written.st_size) > output_limit_) {
    answer.status = kSignalled + SIGXFSZ;
    return answer;
  }
  if (!read_all(output_.get(), answer.output) || !read_all(errors_.get(), answer.errors)) {
    return base::failure("what {} wrote cannot be read: {}", program_, record::system_message(errno));
  }
  return answer;
}

base::Result<std::optional<ChildAnswer>> ask_program(const std::string& program,
                                                     std::vector<std::string> arguments,
                                                     std::string_view input,
                                                     std::optional<std::chrono::milliseconds> longest) {
  auto child = ChildProcess::start(program, std::move(arguments), input);
  if (!child) return tl::unexpected(child.error());
  if (!*child) return std::nullopt;
  if (longest && !ends_within((*child)->ended(), *longest)) {
    (*child)->end();
    if (auto killed = (*child)->wait(); !killed) return tl::unexpected(killed.error());
    return base::failure("{} did not end within {} s and was killed", program,
                         std::chrono::duration<double>(*longest).count());
  }
  auto answer = (*child)->wait();
  if (!answer) return tl::unexpected(answer.error());
  return *std::move(answer);
}

}  // namespace stickslip::io
