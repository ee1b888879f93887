/// \file
/// What can be said from peak to peak without the model: periods, and the drift of the mean.
#pragma once

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Slope of the means from peak to peak against time, by least squares: an oscillation averages out.
[[nodiscard]] Estimate drift_of(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips);

/// The same as something to take off before the model is fitted: none unless it is significant, so that a
/// test without drift stays as it is.
[[nodiscard]] estimate::Drift significant_drift(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips);

/// Fills period_median and oscillation_frequency. A ring-down's frequency is that of the fitted
/// oscillator (results.omega), else it is cycles over time.
void period_results(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                    TestResults& results);

}  // namespace stickslip::analysis
