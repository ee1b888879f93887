/// \file
/// What a scene may ask of the sampling stage: when the converter looks, and which looks are lost.
#pragma once

namespace stickslip::sim {

/// Effect `clock_rate_error`: the converter's clock is off by a constant factor that nobody knows of.
struct ClockRateError {
  double relative = 0.0;  ///< True scan rate over the nominal one, less 1.

  bool operator==(const ClockRateError&) const = default;
};

/// Effect `clock_jitter`: each scan is early or late by its own normal number. It moves the instant at
/// which the motion is seen; a force that does not change does not notice.
struct ClockJitter {
  double sd_s = 0.0;
};

/// Effect `missing_scans`: bursts of scans that never arrive, at random times and of random length.
struct MissingScans {
  double rate_per_s = 0.0;         ///< Bursts in each second between bursts.
  double mean_length_scans = 1.0;  ///< ≥ 1; lengths are geometric: each further scan is as likely.
};

}  // namespace stickslip::sim
