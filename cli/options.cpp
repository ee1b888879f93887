#include "cli/options.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace stickslip::cli {

base::Result<std::optional<double>> number_of(const char* option, const std::string& text,
                                              base::Dimension dimension, bool must_be_positive,
                                              base::BareNumber bare) {
  if (text.empty()) return std::optional<double>{};
  const base::Result<base::EnteredQuantity> entered = base::enter_quantity(text, dimension, bare);
  if (!entered) return base::usage_error("{}: {}", option, entered.error().message);
  if (must_be_positive && !(entered->value > 0.0)) {
    return base::usage_error("{}: \"{}\" must be above 0 {}", option, text, base::si_unit(dimension));
  }
  if (!entered->warning.empty()) fmt::print(stderr, "warning: {}: {}\n", option, entered->warning);
  return std::optional<double>{entered->value};
}

}  // namespace stickslip::cli
