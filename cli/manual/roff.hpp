/// \file
/// Text for the man macros of roff.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::manual {

/// In roff a backslash begins a command, as do a dot and a quote at the beginning of a line; a plain minus is
/// a hyphen that pagers may break at, and is copied as one.
[[nodiscard]] inline std::string roff(std::string_view text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    begins = c == '\n';
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

/// Lines as they are.
[[nodiscard]] inline std::string roff_example(std::string_view text) {
  return ".nf\n" + roff(text) + "\n.fi\n";
}

}  // namespace stickslip::manual
