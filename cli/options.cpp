#include "cli/options.hpp"

namespace stickslip::cli {

base::Result<std::optional<double>> number_of(const char* option, const std::string& text,
                                              base::Dimension dimension, bool must_be_positive) {
  if (text.empty()) return std::optional<double>{};
  base::Result<double> value = base::parse_number(text);
  if (!value) value = base::parse_quantity(text, dimension);
  if (!value) return base::usage_error("{}: {}", option, value.error().message);
  if (must_be_positive && !(*value > 0.0)) {
    return base::usage_error("{}: \"{}\" must be above 0 {}", option, text, base::si_unit(dimension));
  }
  return std::optional<double>{*value};
}

}  // namespace stickslip::cli
