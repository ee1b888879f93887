/// \file
/// A program that is asked one thing and answers it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::daemon {

struct ChildAnswer {
  int status = 0;      ///< Its exit status; 128 and the signal's number if a signal ended it.
  std::string output;  ///< What it wrote to its standard output,
  std::string errors;  ///< and to its standard error.
};

/// Starts a program without the user's environment, gives it the input and waits for its end.
/// \param program  a path, or a name that is looked for in PATH. \return nothing if there is no such program.
/// Errors: kFailure if it cannot be started, waited for or read.
[[nodiscard]] base::Result<std::optional<ChildAnswer>> ask_program(const std::string& program,
                                                                   std::vector<std::string> arguments,
                                                                   std::string_view input);

}  // namespace stickslip::daemon
