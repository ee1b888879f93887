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

class JitteringClock {
 public:
  static constexpr std::string_view kName = "clock_jitter";

  JitteringClock(const ClockJitter& settings, double scan_rate_Hz)
      : sd_scans_(settings.sd_s * scan_rate_Hz) {}

  void restart(std::uint64_t seed);

  /// Instant of a scan. Call for all scans in order, from 0 on. Instants are clipped so that none lies before
  /// the start or the one before; with a standard deviation of up to a tenth of a scan period this affects
  /// deviations of seven standard deviations only.
  [[nodiscard]] ScanTime instant(std::int64_t scan);

 private:
  double sd_scans_;
  ScanTime last_;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace stickslip::sim
