/// \file
/// Sampling instants of a converter with jitter.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

#include <boost/random/normal_distribution.hpp>

#include "core/sim/sampling_settings.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// Instants of a clock with independent normal errors. Call restart() first.
class JitteringClock {
 public:
  static constexpr std::string_view kName = "clock_jitter";

  /// \param scan_rate_Hz  true.
  JitteringClock(const ClockJitter& settings, double scan_rate_Hz)
      : sd_scans_(settings.sd_s * scan_rate_Hz) {}

  /// Returns to scan 0. \param seed  of the scene's run.
  void restart(std::uint64_t seed);

  /// Instant of a scan. Call for all scans in order, from 0 on. Instants are clipped so that none lies before
  /// the start or the one before. So scan 0 is never early. Later scans are clipped only where the errors of
  /// two neighbours differ by a scan period or more: ten standard deviations, if sd_s is a tenth of it.
  [[nodiscard]] ScanTime instant(std::int64_t scan);

 private:
  double sd_scans_;
  ScanTime last_;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace stickslip::sim
