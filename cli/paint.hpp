/// \file
/// Colours for people at a terminal; for files, pipes and programs there are none.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::cli {

enum class Ink { kNone, kGreen, kYellow, kRed, kBlue, kBold, kFaint };

/// Whether stdout is a terminal that wants colours: NO_COLOR is absent or empty (https://no-color.org), TERM
/// is there and not "dumb".
[[nodiscard]] bool wants_colours();

class Paint {
 public:
  explicit Paint(bool on) : on_(on) {}

  /// The text as base::printable() has it; without colours nothing else.
  [[nodiscard]] std::string operator()(Ink colour, std::string_view text) const;

 private:
  bool on_;
};

}  // namespace stickslip::cli
