/// \file
/// One cycle of stick and slip, as detected.
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/scan_index.hpp"

namespace stickslip::detect {

/// Bits of Cycle::flags.
enum CycleFlag : std::uint8_t {
  kCycleHasSpike = 1U << 0U,     ///< A spike was replaced inside.
  kCycleHasGap = 1U << 1U,       ///< Scans are missing inside.
  kCycleIsSaturated = 1U << 2U,  ///< The converter was at a rail inside.
  kCycleCaptured = 1U << 3U,     ///< The slip ended in sticking.
  kCycleIsFirst = 1U << 4U,      ///< The first slip of the pull, or after a hold: not representative.
};

/// A cycle, from one slip to the next. Times are seconds after scan 0 of the test's record: (scan index −
/// first index of the record) / granted rate. NaN if unknown.
struct Cycle {
  std::int64_t number = 0;         ///< From 0.
  base::ScanIndex first_scan = 0;  ///< Scan nearest to the peak, index of the acquisition.
  double onset_time_s = 0.0;       ///< Slip onset.
  double capture_time_s = 0.0;     ///< Slip ends in sticking; NaN if it does not.
  double peak_time_s = 0.0;        ///< Maximum of the force, interpolated between scans.
  double period_s = 0.0;           ///< Peak to next peak; NaN for the last cycle.
  double stick_time_s = 0.0;       ///< Capture of the slip before to this onset; NaN if not seen.
  double slip_time_s = 0.0;        ///< Onset to capture; NaN if not captured.
  double peak = 0.0;               ///< Coefficient at the maximum, interpolated.
  double trough = 0.0;             ///< Coefficient at the following minimum, interpolated.
  double force_drop = 0.0;         ///< peak − trough, as a coefficient.
  double delta_mu = 0.0;           ///< S − K of this slip; NaN if not estimated.
  double delta_mu_standard_error = 0.0;
  double slip_speed_ratio = 0.0;  ///< Largest slip speed over drive speed [Penner 1995, (18)].
  std::uint8_t flags = 0;         ///< CycleFlag bits.
  /// Pull speed at the onset if the speed changes; else NaN.
  double pull_speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  /// Log-likelihood ratio of capture over free oscillation; > 0 for captured. From the fit of the whole test,
  /// or, without that, from the time the cycle closed; NaN if undetermined, as for the last slip.
  double capture_evidence = std::numeric_limits<double>::quiet_NaN();
  /// Log-likelihood ratio at the live decision, and the time of that decision.
  double live_capture_evidence = std::numeric_limits<double>::quiet_NaN();
  double live_decision_time_s = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace stickslip::detect
