/// \file
/// Runs gnuplot.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"

namespace stickslip::plot {

/// What gnuplot writes when it is given these commands: without a shell, without anybody's settings.
/// Errors: kFailure if it is not installed, cannot be started, or ends with an error (its own words).
[[nodiscard]] base::Result<std::string> run_gnuplot(std::string_view commands);

}  // namespace stickslip::plot
