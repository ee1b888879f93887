/// \file
/// Prints text to a terminal without letting it control the terminal.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include "core/base/text.hpp"

namespace stickslip::io {

/// Prints a text of several lines; characters that could control the terminal are shown by their number. Line
/// feeds pass: the caller escapes those inside names with base::printable(). \param has_colours  true: colour
/// sequences of Paint pass too.
inline void print_text(std::FILE* stream, std::string_view text, bool has_colours = false) {
  fmt::print(stream, "{}", base::printable_lines(text, has_colours));
}

/// Prints one line to stderr: "PROGRAM: WHY".
inline void print_error(std::string_view program, std::string_view why) {
  fmt::print(stderr, "{}: {}\n", program, base::printable(why));
}

}  // namespace stickslip::io
