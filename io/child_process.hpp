/// \file
/// Runs a program as a child process: input on its standard input, answer from its standard output.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file.hpp"

namespace stickslip::io {

struct ChildAnswer {
  int status = 0;      ///< Its exit status; 128 plus the signal's number if a signal ended it.
  std::string output;  ///< What it wrote to its standard output.
  std::string errors;  ///< What it wrote to its standard error.
};

/// Limits of a child. The kernel enforces them, also after this process has ended.
struct ChildLimits {
  std::chrono::seconds processor_time{0};  ///< SIGXCPU ends a child that takes more; 0: no limit.
  std::size_t output_size = 0;  ///< Bytes of one file; SIGXFSZ ends a child that writes more; 0: no limit.
  int niceness = 0;             ///< 0 … 19, added to this process's.
};

/// A running child process. Thread-bound.
class ChildProcess {
 public:
  /// Starts a program without the user's environment but `variables` ("NAME=value"); `input` is its standard
  /// input. \param program  a path, or a name that is looked for in PATH. \return nothing if there is no such
  /// program. Errors: kFailure if it cannot be started.
  [[nodiscard]] static base::Result<std::optional<ChildProcess>> start(
      const std::string& program, std::vector<std::string> arguments, std::string_view input,
      const ChildLimits& limits = {}, std::vector<std::string> variables = {});
  /// Kills the child (SIGKILL) unless wait() has returned.
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// A new descriptor of the process (pidfd_open(2)), which becomes readable when the child ends. It is not
  /// open if the system refuses.
  [[nodiscard]] record::Descriptor ended() const;
  /// Kills the child (SIGKILL). wait() then returns the status 128 + SIGKILL.
  void end() noexcept;
  /// Blocks until the child ends and returns its answer. Call it once. Errors: kFailure if waiting or reading
  /// fails.
  [[nodiscard]] base::Result<ChildAnswer> wait();

 private:
  ChildProcess(std::string program, pid_t child, record::Descriptor output, record::Descriptor errors,
               std::size_t output_limit);

  std::string program_;
  pid_t child_;  ///< 0 after wait().
  record::Descriptor output_;
  record::Descriptor errors_;
  std::size_t output_limit_;  ///< 0: none.
};

/// Starts a program as ChildProcess::start() does and blocks until it ends. \param program  a path, or a name
/// that is looked for in PATH. \param longest  the program is killed after this time; absent: never.
/// \return nothing if there is no such program. Errors: kFailure if it cannot be started, waited for or read,
/// or takes too long.
[[nodiscard]] base::Result<std::optional<ChildAnswer>> ask_program(
    const std::string& program, std::vector<std::string> arguments, std::string_view input,
    std::optional<std::chrono::milliseconds> longest = std::nullopt);

}  // namespace stickslip::io
