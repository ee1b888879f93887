#include "daemon/plot/gnuplot.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "core/base/wording.hpp"
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

base::Result<std::string> run_gnuplot(std::string_view commands) {
  const record::Descriptor input = memory_file("gnuplot-commands");
  const record::Descriptor output = memory_file("gnuplot-picture");
  const record::Descriptor errors = memory_file("gnuplot-errors");
  if (!input.open() || !output.open() || !errors.open() || !write_all(input.get(), commands)) {
    return base::failure("no memory for a picture: {}", record::system_message(errno));
  }

  std::string program = "gnuplot";
  std::string own_settings = "--default-settings";
  const std::array<char*, 3> arguments{program.data(), own_settings.data(), nullptr};
  // Nothing of the user's: neither language nor variables that gnuplot knows.
  std::string locale = "LC_ALL=C.UTF-8";
  const std::array<char*, 2> environment{locale.data(), nullptr};
  const Redirections redirections{input.get(), output.get(), errors.get()};
  pid_t child = 0;
  if (const int error = posix_spawnp(&child, program.c_str(), redirections.get(), nullptr, arguments.data(),
                                     environment.data());
      error == ENOENT) {
    return base::failure(
        "pictures are drawn by gnuplot, which is not installed; on Debian: apt-get install gnuplot-nox");
  } else if (error != 0) {
    return base::failure("gnuplot cannot be started: {}", record::system_message(error));
  }
  int status = 0;
  while (waitpid(child, &status, 0) == -1) {
    if (errno != EINTR)
      return base::failure("gnuplot cannot be waited for: {}", record::system_message(errno));
  }
  std::string picture;
  std::string words;
  if (!read_all(output.get(), picture) || !read_all(errors.get(), words)) {
    return base::failure("the picture that gnuplot drew cannot be read: {}", record::system_message(errno));
  }
  if (WIFSIGNALED(status)) return base::failure("gnuplot was ended by signal {}", WTERMSIG(status));
  constexpr std::size_t kLongestWords = 300;
  if (WEXITSTATUS(status) != 0 || picture.empty()) {
    return base::failure("gnuplot ended with status {}: {}", WEXITSTATUS(status),
                         base::one_line(words, kLongestWords));
  }
  return picture;
}

}  // namespace stickslip::daemon
