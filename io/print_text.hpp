/// \file
/// The one way of text to a terminal.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string_view>

#include "core/base/text.hpp"

namespace stickslip::io {

/// A whole output with its line feeds. What a name in it could do to a terminal is shown by its number; a
/// line feed within a name is for who writes the line to show, by base::printable(). \param has_colours those
/// of Paint stay.
inline void print_text(std::FILE* stream, std::string_view text, bool has_colours = false) {
  fmt::print(stream, "{}", base::printable_lines(text, has_colours));
}

/// "stickslip: why", one line.
inline void print_error(std::string_view program, std::string_view why) {
  fmt::print(stderr, "{}: {}\n", program, base::printable(why));
}

}  // namespace stickslip::io
