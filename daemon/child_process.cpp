#include "daemon/child_process.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "core/record/file.hpp"

namespace stickslip::daemon {
namespace {

/// Files in memory stand at the child's ends: none of them can fill up while the other side waits, as pipes
/// can.
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

/// What stands at the child's descriptors 0, 1 and 2.
class Redirections {
 public:
  Redirections(int input, int output, int errors) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, errors, STDERR_FILENO);
  }
  ~Redirections() { posix_spawn_file_actions_destroy(&actions_); }
  Redirections(const Redirections&) = delete;
  Redirections& operator=(const Redirections&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

base::Result<std::optional<ChildAnswer>> ask_program(const std::string& program,
                                                     std::vector<std::string> arguments,
                                                     std::string_view input_text) {
  const record::Descriptor input = memory_file("input");
  const record::Descriptor output = memory_file("output");
  const record::Descriptor errors = memory_file("errors");
  if (!input.open() || !output.open() || !errors.open() || !write_all(input.get(), input_text)) {
    return base::failure("no memory to ask {}: {}", program, record::system_message(errno));
  }
  std::string name = program;
  std::vector<char*> argument_list{name.data()};
  for (std::string& argument : arguments) argument_list.push_back(argument.data());
  argument_list.push_back(nullptr);
  // Nothing of the user's: neither language nor variables that the program knows.
  std::string locale = "LC_ALL=C.UTF-8";
  const std::array<char*, 2> environment{locale.data(), nullptr};
  const Redirections redirections{input.get(), output.get(), errors.get()};
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, program.c_str(), redirections.get(), nullptr,
                                     argument_list.data(), environment.data());
      error == ENOENT) {
    return std::nullopt;
  } else if (error != 0) {
    return base::failure("{} cannot be started: {}", program, record::system_message(error));
  }
  int status = 0;
  while (waitpid(child, &status, 0) == -1) {
    if (errno != EINTR)
      return base::failure("{} cannot be waited for: {}", program, record::system_message(errno));
  }
  ChildAnswer answer;
  if (!read_all(output.get(), answer.output) || !read_all(errors.get(), answer.errors)) {
    return base::failure("what {} wrote cannot be read: {}", program, record::system_message(errno));
  }
  constexpr int kSignalled = 128;  // As shells count.
  answer.status = WIFSIGNALED(status) ? kSignalled + WTERMSIG(status) : WEXITSTATUS(status);
  return answer;
}

}  // namespace stickslip::daemon
