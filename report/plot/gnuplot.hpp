/// \file
/// Runs gnuplot.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::plot {

/// Runs gnuplot with these commands, without a shell and without user settings, and returns its output;
/// blocks. Errors: kFailure if it is not installed, cannot be started, or fails (with its message).
[[nodiscard]] base::Result<std::string> run_gnuplot(std::string_view commands);

}  // namespace stickslip::plot
