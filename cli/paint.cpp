#include "cli/paint.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

#include "core/base/text.hpp"

namespace stickslip::cli {
namespace {

/// ECMA-48, SGR.
std::string_view code_of(Ink colour) {
  switch (colour) {
    case Ink::kNone:
      break;
    case Ink::kGreen:
      return "32";
    case Ink::kYellow:
      return "33";
    case Ink::kRed:
      return "31";
    case Ink::kBlue:
      return "34";
    case Ink::kBold:
      return "1";
    case Ink::kFaint:
      return "2";
  }
  return {};
}

}  // namespace

bool wants_colours() {
  const char* const no_color = std::getenv("NO_COLOR");
  if (no_color != nullptr && *no_color != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view{terminal} != "dumb" && ::isatty(STDOUT_FILENO) != 0;
}

std::string Paint::operator()(Ink colour, std::string_view text) const {
  const std::string_view code = code_of(colour);
  std::string shown = base::printable(text);
  if (!on_ || code.empty()) return shown;
  return fmt::format("\033[{}m{}\033[0m", code, shown);
}

}  // namespace stickslip::cli
