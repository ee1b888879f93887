/// \file
/// Traditional static and kinetic coefficient of a test. [Penner 1995, Experimental]
#pragma once

#include <optional>

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/method.hpp"

namespace stickslip::analysis {

struct TraditionalCoefficients {
  Estimate static_coefficient;   ///< Largest scan of the peak of slip method.static_slip.
  Estimate kinetic_coefficient;  ///< Mean over the cycles, peak to peak, or the travel after the first peak.
};

/// \param trace  not empty.
/// \param slips  in the order of time. Without slips there is no static coefficient, and the kinetic one is
///        the mean of the trace without loading and unloading; a travel window then counts from the end of
///        the loading.
/// \param pull_speed_m_per_s  nominal, > 0; required by a travel window.
[[nodiscard]] TraditionalCoefficients traditional_coefficients(const estimate::Trace& trace,
                                                               const base::LongColumn<detect::Fall>& slips,
                                                               const model::Method& method,
                                                               std::optional<double> pull_speed_m_per_s = {});

/// Mean over all cycles of the trace, peak to peak, and over ten periods from the first peak on where the
/// oscillation dies away before: whatever the method averages. No value of a single slip.
[[nodiscard]] Estimate mean_force(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips);

/// Whether the trace begins while the sled slides: half of its first scans are above half of the largest. The
/// first peak is then no static one.
[[nodiscard]] bool begins_under_load(const estimate::Trace& trace);

}  // namespace stickslip::analysis
