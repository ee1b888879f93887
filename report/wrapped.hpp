/// \file
/// Lines for a terminal of 80 columns.
#pragma once

#include <cstddef>
#include <string>

namespace stickslip::report {

/// Breaks a line at blanks so that it fits a terminal of 80 columns. \param indent  blanks before all lines
/// but the first.
[[nodiscard]] std::string wrapped(const std::string& line, std::size_t indent);

}  // namespace stickslip::report
