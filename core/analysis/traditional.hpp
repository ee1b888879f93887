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
  /// Largest of the three scans about the peak of slip method.static_slip; absent with fewer slips.
  Estimate static_coefficient;
  /// Mean over the method's cycles, peak to peak, or over its travel after the first peak; absent if the
  /// trace ends before.
  Estimate kinetic_coefficient;
};

/// Means leave out scans that are not usable, and those during which the belt stood still. With fewer peaks
/// than the method's cycles need, the mean goes on over mean periods if the trace lasts so long; with a
/// single slip there is none over cycles.
/// \param trace  not empty.
/// \param slips  in the order of time. Without slips there is no static coefficient, and the kinetic one is
///        the mean from the first to the last scan of at least half the largest force; a travel window then
///        counts from that first scan.
/// \param pull_speed_m_per_s  nominal, > 0; without it a travel window has no value.
[[nodiscard]] TraditionalCoefficients traditional_coefficients(const estimate::Trace& trace,
                                                               const base::LongColumn<detect::Fall>& slips,
                                                               const model::Method& method,
                                                               std::optional<double> pull_speed_m_per_s = {});

/// Mean force from the first peak to the last, as a coefficient, whatever the method averages. With fewer
/// than ten cycles, as where the oscillation dies away, over ten mean periods from the first peak on if the
/// trace lasts so long. Absent with fewer than two slips.
[[nodiscard]] Estimate mean_force(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips);

/// Whether the trace begins while the sled slides: more than half of its first five scans are at least half
/// of the largest. The first peak is then no static one.
[[nodiscard]] bool begins_under_load(const estimate::Trace& trace);

}  // namespace stickslip::analysis
