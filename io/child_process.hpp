/// \file
/// A program that is asked one thing and answers it.
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
  int status = 0;      ///< Its exit status; 128 and the signal's number if a signal ended it.
  std::string output;  ///< What it wrote to its standard output,
  std::string errors;  ///< and to its standard error.
};

/// What a child may take. It holds even where nobody waits for the child any more.
struct ChildLimits {
  std::chrono::seconds processor_time{0};  ///< SIGXCPU ends a child that takes more; 0: no limit.
  std::size_t output_size = 0;             ///< Bytes; SIGXFSZ ends a child that writes more; 0: no limit.
  int niceness = 0;                        ///< 0 … 19, beside this process.
};

/// A program that runs. Thread-bound.
class ChildProcess {
 public:
  /// Starts a program without the user's environment and gives it the input.
  /// \param program  a path, or a name that is looked for in PATH. \return nothing if there is no such
  /// program. Errors: kFailure if it cannot be started.
  [[nodiscard]] static base::Result<std::optional<ChildProcess>> start(const std::string& program,
                                                                       std::vector<std::string> arguments,
                                                                       std::string_view input,
                                                                       const ChildLimits& limits = {});
  /// Ends it where nobody has waited for it.
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  /// Another descriptor of the process (pidfd_open(2)): readable once it has ended. Not open if the system
  /// refuses.
  [[nodiscard]] record::Descriptor ended() const;
  /// By SIGKILL. wait() tells so.
  void end() noexcept;
  /// Waits for its end; once. Errors: kFailure if it cannot be waited for or read.
  [[nodiscard]] base::Result<ChildAnswer> wait();

 private:
  ChildProcess(std::string program, pid_t child, record::Descriptor output, record::Descriptor errors,
               std::size_t output_limit);

  std::string program_;
  pid_t child_;  ///< 0: it has been waited for.
  record::Descriptor output_;
  record::Descriptor errors_;
  std::size_t output_limit_;  ///< 0: none.
};

/// Starts a program without the user's environment, gives it the input and waits for its end.
/// \param program  a path, or a name that is looked for in PATH. \return nothing if there is no such program.
/// Errors: kFailure if it cannot be started, waited for or read.
[[nodiscard]] base::Result<std::optional<ChildAnswer>> ask_program(const std::string& program,
                                                                   std::vector<std::string> arguments,
                                                                   std::string_view input);

}  // namespace stickslip::io
