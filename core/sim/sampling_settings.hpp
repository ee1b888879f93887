/// \file
/// Settings of the sampling stage: sampling instants and missing scans.
#pragma once

namespace stickslip::sim {

/// Effect `clock_rate_error`: the converter's clock has a constant relative error, unknown to the evaluation.
struct ClockRateError {
  double relative = 0.0;  ///< True scan rate over the nominal one, less 1.

  bool operator==(const ClockRateError&) const = default;
};

/// Effect `clock_jitter`: each sampling instant has an independent normal error. It changes the instant at
/// which the motion is sampled; a constant force is unaffected.
struct ClockJitter {
  double sd_s = 0.0;
};

/// Effect `missing_scans`: bursts of scans that never arrive, at random times and of random length.
struct MissingScans {
  double rate_per_s = 0.0;         ///< Mean number of bursts in a second that is outside of bursts, > 0.
  double mean_length_scans = 1.0;  ///< ≥ 1; the lengths are geometrically distributed.
};

}  // namespace stickslip::sim
