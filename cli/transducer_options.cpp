#include "cli/transducer_options.hpp"

#include <fmt/format.h>

#include <cmath>
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
  if (!(*frequency_Hz >= model::kSlowestTransducer_Hz && *frequency_Hz <= model::kFastestTransducer_Hz)) {
    return base::usage_error("{} {}: must be {} Hz to {} MHz", option, base::one_line(text, 40),
                             model::kSlowestTransducer_Hz, 1e-6 * model::kFastestTransducer_Hz);
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
  text("--anti-alias-order", options.anti_alias_order, "its order, 1 to 8; default 4", "N");
}

Result<model::Transducer> stated_transducer(const TransducerOptions& options) {
  const auto cell_Hz = frequency_of("--load-cell-frequency", options.load_cell_frequency);
  if (!cell_Hz) return tl::unexpected(cell_Hz.error());
  const auto filter_Hz = frequency_of("--anti-alias", options.anti_alias);
  if (!filter_Hz) return tl::unexpected(filter_Hz.error());
  if (!options.load_cell_damping.empty() && !*cell_Hz)
    return base::usage_error("--load-cell-damping needs --load-cell-frequency, such as \"120 Hz\"");
  if (!options.anti_alias_order.empty() && !*filter_Hz)
    return base::usage_error("--anti-alias-order needs --anti-alias, such as \"60 Hz\"");
  const auto damping =
      number_of("--load-cell-damping", options.load_cell_damping, model::kTypicalCellDamping);
  if (!damping) return tl::unexpected(damping.error());
  if (!(*damping >= 0.0 && *damping <= model::kLargestCellDamping)) {
    return base::usage_error("--load-cell-damping {}: must be 0 to {}",
                             base::one_line(options.load_cell_damping, 40), model::kLargestCellDamping);
  }
  const auto order = number_of("--anti-alias-order", options.anti_alias_order, model::kTypicalFilterOrder);
  if (!order) return tl::unexpected(order.error());
  if (*order != std::floor(*order) || *order < 1.0 || *order > model::AntiAlias::kHighestOrder) {
    return base::usage_error("--anti-alias-order {}: must be a whole number of 1 to {}",
                             base::one_line(options.anti_alias_order, 40), model::AntiAlias::kHighestOrder);
  }
  model::Transducer transducer;
  if (*cell_Hz) transducer.load_cell = {**cell_Hz, *damping};
  if (*filter_Hz) transducer.anti_alias = {**filter_Hz, static_cast<int>(*order)};
  return transducer;
}

}  // namespace stickslip::cli
