/// \file
/// Text for the man macros of roff.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::manual {

/// Escapes a text for roff: backslashes, a dot or quote at the beginning of a line (both begin commands), and
/// minus signs (unescaped they become hyphens, which break lines and are copied wrongly).
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

/// A text whose lines stay as they are.
[[nodiscard]] inline std::string roff_example(std::string_view text) {
  return ".nf\n" + roff(text) + "\n.fi\n";
}

}  // namespace stickslip::manual
