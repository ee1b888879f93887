/// \file
/// Statistics from peak to peak, without the model: periods, and the drift of the mean.
#pragma once

#include <optional>
#include <string>

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/regime_rule.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Slope of the means from peak to peak against time, by least squares: an oscillation averages out.
[[nodiscard]] Estimate drift_of(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips);

/// Drift to subtract before the model is fitted; zero unless drift_of() is significant.
[[nodiscard]] estimate::Drift significant_drift(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips);

/// The finding if the level about which slips swing differs between the first and the last third of them by
/// more than it wanders in between, at the level of three standard deviations: S and K then hold for this
/// stretch of the track alone. Cycles with a break do not count; a belt of changing speed has no level.
[[nodiscard]] std::optional<base::Finding> level_finding(const estimate::Trace& trace,
                                                         const base::LongColumn<detect::Fall>& slips);

/// Shape of the cycles, of which each has a fall and the rise to the next.
[[nodiscard]] detect::CycleShape cycle_shape(const estimate::Trace& trace,
                                             const base::LongColumn<detect::Fall>& slips);

/// Fills period_median and oscillation_frequency. A ring-down's frequency is that of the fitted
/// oscillator (results.omega), else it is cycles over time.
void period_results(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                    TestResults& results);

}  // namespace stickslip::analysis
