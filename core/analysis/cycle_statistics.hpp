/// \file
/// Statistics of the cycles from peak to peak, without a fit: period, drift and level of the mean, shape.
#pragma once

#include <optional>
#include <string>

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/regime_rule.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Drift of the coefficient, 1/s, with its standard error: slope of the means from peak to peak against time,
/// by least squares. An oscillation averages out of these means. Cycles with a break or a hold are left out;
/// absent if fewer than three are left.
[[nodiscard]] Estimate drift_of(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips);

/// Drift to subtract before the model is fitted. Its rate is drift_of() if that differs from zero at the 1 %
/// level (Student's t), else 0. The drift is zero at the mean time of the peaks after the first.
[[nodiscard]] estimate::Drift significant_drift(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips);

/// Finding kLevelDrift if the level about which the slips swing differs between the first and the last third
/// of the cycles, at the level of three standard deviations, by more than its wandering within each third
/// explains. S and K then hold for this stretch of the track alone. Cycles with a break do not count. Nullopt
/// also for fewer than 25 slips, for fewer than eight cycles that count in one of the thirds, and if
/// trace.belt is not constant.
[[nodiscard]] std::optional<base::Finding> level_finding(const estimate::Trace& trace,
                                                         const base::LongColumn<detect::Fall>& slips);

/// Shape of the cycles, each a fall and the rise to the next peak. Cycles with a break are left out; if fewer
/// than three are left, only the count is set.
[[nodiscard]] detect::CycleShape cycle_shape(const estimate::Trace& trace,
                                             const base::LongColumn<detect::Fall>& slips);

/// Fills period_median, s, without a standard error, and oscillation_frequency, Hz. The frequency of a
/// ring-down is that of the fitted oscillator (results.omega), if it has a value; else it is cycles over
/// time. Cycles with a break or a hold are left out; both results are absent if none is left.
/// \param results  regime and omega are read.
void period_results(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                    TestResults& results);

}  // namespace stickslip::analysis
