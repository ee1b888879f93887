#include "cli/transducer_options.hpp"

#include <fmt/format.h>

#include <optional>

#include "core/base/quantity.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"

namespace stickslip::cli {
namespace {

using base::Dimension;
using base::Result;

/// Nothing if `text` is empty.
Result<std::optional<double>> frequency_of(const char* option, const std::string& text) {
  if (text.empty()) return std::optional<double>{};
  const Result<double> frequency_Hz = base::parse_quantity(text, Dimension::kFrequency);
  if (!frequency_Hz) return base::usage_error("{}: {}", option, frequency_Hz.error().message);
  if (!(*frequency_Hz > 0.0)) {
    return base::usage_error("{} {}: must be above 0, such as \"120 Hz\"", option, base::one_line(text, 40));
  }
  return std::optional{*frequency_Hz};
}

/// The fallback if `text` is empty.
Result<double> number_of(const char* option, const std::string& text, double fallback) {
  if (text.empty()) return fallback;
  const Result<double> number = base::parse_quantity(text, Dimension::kDimensionless);
  if (!number) return base::usage_error("{}: {}", option, number.error().message);
  return *number;
}

}  // namespace

void add_transducer_options(CLI::App& command, TransducerOptions& options) {
  const auto text = [&command](const char* name, std::string& into, const char* what, const char* type) {
    command.add_option(name, into, what)->type_name(type);
  };
  text("--load-cell-frequency", options.load_cell_frequency,
       "natural frequency of the load cell, with unit: \"120 Hz\"; results are those of the force on it",
       "F");
  text("--load-cell-damping", options.load_cell_damping,
       "its damping over the critical one, 0 to 0.99; default 0.05", "RATIO");
  text("--anti-alias", options.anti_alias,
       "where the Butterworth low-pass before the converter takes 3 dB, with unit: \"60 Hz\"", "F");
  text("--anti-alias-order", options.anti_alias_order, "its order: 2, 4, 6 or 8; default 4", "N");
}

Result<model::Transducer> stated_transducer(const TransducerOptions& options) {
  model::Transducer transducer;
  const auto cell = frequency_of("--load-cell-frequency", options.load_cell_frequency);
  if (!cell) return tl::unexpected(cell.error());
  transducer.load_cell_frequency_Hz = *cell;
  const auto filter = frequency_of("--anti-alias", options.anti_alias);
  if (!filter) return tl::unexpected(filter.error());
  transducer.anti_alias_Hz = *filter;
  if (!options.load_cell_damping.empty() && !*cell)
    return base::usage_error("--load-cell-damping needs --load-cell-frequency, such as \"120 Hz\"");
  if (!options.anti_alias_order.empty() && !*filter)
    return base::usage_error("--anti-alias-order needs --anti-alias, such as \"60 Hz\"");
  const auto damping =
      number_of("--load-cell-damping", options.load_cell_damping, transducer.load_cell_damping);
  if (!damping) return tl::unexpected(damping.error());
  if (!(*damping >= 0.0 && *damping <= model::kLargestCellDamping)) {
    return base::usage_error("--load-cell-damping {}: must be 0 to {}",
                             base::one_line(options.load_cell_damping, 40), model::kLargestCellDamping);
  }
  transducer.load_cell_damping = *damping;
  const auto order = number_of("--anti-alias-order", options.anti_alias_order, transducer.anti_alias_order);
  if (!order) return tl::unexpected(order.error());
  for (int even = model::kLowestFilterOrder; even <= model::kHighestFilterOrder; even += 2) {
    if (*order != even) continue;
    transducer.anti_alias_order = even;
    return transducer;
  }
  return base::usage_error("--anti-alias-order {}: must be 2, 4, 6 or 8",
                           base::one_line(options.anti_alias_order, 40));
}

}  // namespace stickslip::cli
