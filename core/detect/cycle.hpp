/// \file
/// Cycle: a row of a test's table of cycles, from one slip to the next, whether or not the sled stuck in
/// between. Filled while the test runs, and anew at its end.
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/scan_index.hpp"

namespace stickslip::detect {

/// Bits of Cycle::flags. "Inside" is from this peak to the next; in the last cycle to its trough. While the
/// test runs, the last cycle reaches to the end of the test; one whose ring-down has died away ends where its
/// slip was confirmed, in the rise after the trough.
enum CycleFlag : std::uint8_t {
  kCycleHasSpike = 1U << 0U,  ///< A spike was replaced inside.
  kCycleHasGap = 1U << 1U,    ///< Scans are missing inside.
  /// The converter was at a rail inside; after the test also: the force was clipped before it or stood still.
  kCycleIsSaturated = 1U << 2U,
  kCycleCaptured = 1U << 3U,  ///< The slip ended in sticking; not set if unknown.
  /// The first slip of the test, or (set at the end of the test) after a hold: not representative.
  kCycleIsFirst = 1U << 4U,
};

/// A cycle, from one slip to the next. Times of events are seconds after the first scan of the test's record:
/// (scan index − first index of the record) / granted rate. Members that are unknown are set to NaN.
struct Cycle {
  std::int64_t number = 0;  ///< From 0.
  /// Scan nearest to the peak, index of the acquisition; LiveDetector::add() counts otherwise.
  base::ScanIndex first_scan = 0;
  double onset_time_s = 0.0;    ///< Slip onset; NaN if the slip did not begin from sticking, or if unknown.
  double capture_time_s = 0.0;  ///< Slip ends in sticking; NaN if not, or if unknown.
  double peak_time_s = 0.0;     ///< Maximum of the force, interpolated between scans.
  /// Peak to next peak; NaN if none. While the test runs also NaN if the ring-down died away; after the test
  /// also before a break.
  double period_s = 0.0;
  /// From the capture before (or rest in a hold) to this onset; after a hold, if the onset is unknown and no
  /// fit describes the test, to the peak.
  double stick_time_s = 0.0;
  double slip_time_s = 0.0;  ///< Onset to capture; NaN if not captured, or if unknown.
  double peak = 0.0;         ///< Coefficient at the maximum, interpolated.
  double trough = 0.0;       ///< Coefficient at the following minimum, interpolated.
  double force_drop = 0.0;   ///< peak − trough, as a coefficient.
  double delta_mu = 0.0;     ///< S − K of this slip; NaN if not estimated.
  double delta_mu_standard_error = 0.0;
  double slip_speed_ratio = 0.0;  ///< Largest slip speed over drive speed, −c′/r [Penner 1995, (18)].
  std::uint8_t flags = 0;         ///< CycleFlag bits.
  /// Pull speed at the onset, if it is measured or changes; else NaN. At the peak if the onset is unknown and
  /// no fit describes the test; NaN if one does. Set at the end of the test.
  double pull_speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  /// Log-likelihood ratio of capture over free oscillation: > 0 speaks for capture. Set at the end of the
  /// test, from the fit of the whole test or, without that, from LiveCycle::evidence; NaN if undetermined, as
  /// for the last slip.
  double capture_evidence = std::numeric_limits<double>::quiet_NaN();
  /// Log-likelihood ratio at the live decision, and LiveCycle::decided_time_s; NaN if there was none.
  double live_capture_evidence = std::numeric_limits<double>::quiet_NaN();
  double live_decision_time_s = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace stickslip::detect
