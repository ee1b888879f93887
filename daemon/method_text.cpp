#include "daemon/method_text.hpp"

#include <charconv>

namespace stickslip::daemon {
namespace {

constexpr std::string_view kSeparator = " kinetic_cycles=";

}  // namespace

std::string method_text(const friction::Method& method) {
  return fmt::format("{}{}{}", method.name, kSeparator, method.kinetic_cycles);
}

base::Result<friction::Method> method_from_text(std::string_view text) {
  friction::Method method;
  if (text.empty()) return method;
  const std::size_t split = text.find(kSeparator);
  int cycles = 0;
  if (split != std::string_view::npos && split > 0) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + split + kSeparator.size(), end, cycles);
    if (error != std::errc{} || stop != end) cycles = 0;
  }
  if (cycles < 1) {
    return base::usage_error("method \"{}\" is not of the form \"NAME{}N\" with N from 1", text, kSeparator);
  }
  method.name = text.substr(0, split);
  method.kinetic_cycles = cycles;
  return method;
}

}  // namespace stickslip::daemon
