/// \file
/// Random bursts of missing scans.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

#include <boost/random/exponential_distribution.hpp>

#include "core/sim/sampling_settings.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// Sequence of bursts of missing scans; scans between them take no computing time. Call restart() first.
class MissingBursts {
 public:
  static constexpr std::string_view kName = "missing_scans";

  /// \param scan_rate_Hz  true.
  MissingBursts(const MissingScans& settings, double scan_rate_Hz);

  /// Returns to the first burst. \param seed  of the scene's run.
  void restart(std::uint64_t seed);

  /// The present burst: scans [first, end) are missing.
  [[nodiscard]] std::int64_t first() const noexcept { return first_; }
  [[nodiscard]] std::int64_t end() const noexcept { return end_; }
  /// Goes to the next burst, which may begin at end().
  void next();

 private:
  double mean_wait_scans_;
  /// Of the exponential numbers whose whole parts are the geometric ones: 1/ln(1/(1 − 1/mean length)).
  double length_scale_scans_;
  std::mt19937_64 generator_;
  boost::random::exponential_distribution<double> exponential_{1.0};
  std::int64_t first_ = 0;
  std::int64_t end_ = 0;
};

}  // namespace stickslip::sim
