#include "cli/transducer_options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string_view>

#include "cli/options.hpp"

#include "core/base/quantity.hpp"
#include "core/base/settings.hpp"

namespace stickslip::cli {
namespace {

using base::Dimension;
using base::Result;

/// number_of() within limits; no frequency without its unit.
Result<std::optional<double>> number_within(const char* option, const std::string& text, Dimension dimension,
                                            const base::Limits& limits) {
  const auto number = number_of(option, text, dimension, false, base::BareNumber::kRefused);
  if (!number || !*number || limits.allow(**number)) return number;
  const std::string_view unit = base::si_unit(dimension);
  return base::usage_error("{} {}: must be {} to {}{}", option, text, limits.min, limits.max,
                           unit == "1" ? "" : fmt::format(" {}", unit));
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
  const base::Limits frequencies =
      base::Limits::between(model::kSlowestTransducer_Hz, model::kFastestTransducer_Hz);
  const auto cell_Hz =
      number_within("--load-cell-frequency", options.load_cell_frequency, Dimension::kFrequency, frequencies);
  if (!cell_Hz) return tl::unexpected(cell_Hz.error());
  const auto damping =
      number_within("--load-cell-damping", options.load_cell_damping, Dimension::kDimensionless,
                    base::Limits::between(0.0, model::kLargestCellDamping));
  if (!damping) return tl::unexpected(damping.error());
  const auto filter_Hz =
      number_within("--anti-alias", options.anti_alias, Dimension::kFrequency, frequencies);
  if (!filter_Hz) return tl::unexpected(filter_Hz.error());
  const auto order = number_within("--anti-alias-order", options.anti_alias_order, Dimension::kDimensionless,
                                   base::Limits::between(1.0, model::AntiAlias::kHighestOrder));
  if (!order) return tl::unexpected(order.error());
  if (*order && **order != std::floor(**order))
    return base::usage_error("--anti-alias-order {}: must be a whole number", options.anti_alias_order);
  if (*damping && !*cell_Hz)
    return base::usage_error("--load-cell-damping needs --load-cell-frequency, such as \"120 Hz\"");
  if (*order && !*filter_Hz)
    return base::usage_error("--anti-alias-order needs --anti-alias, such as \"60 Hz\"");
  model::Transducer transducer;
  if (*cell_Hz) transducer.load_cell = {**cell_Hz, damping->value_or(model::kTypicalCellDamping)};
  if (*filter_Hz)
    transducer.anti_alias = {**filter_Hz, static_cast<int>(order->value_or(model::kTypicalFilterOrder))};
  return transducer;
}

}  // namespace stickslip::cli
