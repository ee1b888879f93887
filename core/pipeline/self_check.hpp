/// \file
/// Is the unloaded tester fit for a test? Noise, hum, spikes, saturation, zero and its drift, from the scans
/// in which nothing pulled.
///
///     const daq::SelfCheck check = check_idle(990, raw, calibration, 350.0);
///     for (const std::string& finding : check.findings) warn(finding);
#pragma once

#include <deque>
#include <optional>
#include <span>

#include "core/daq/calibration.hpp"
#include "core/daq/rate_fit.hpp"
#include "core/daq/self_check.hpp"

namespace stickslip::pipeline {

/// Least squares of the forces, spikes replaced, by a straight line with sine and cosine of 50 and of 60 Hz.
/// A function of its arguments alone: a record that is looked at again says the same to the last bit.
/// \param raw  consecutive scans from `first` on. Fewer than kFewestIdleScans, or less than kShortestIdle_s
/// of
///             them, tell nothing of noise, hum and drift, and a rate that cannot show 60 Hz nothing of hum.
/// \param rate  of all scans so far, as far as known.
[[nodiscard]] daq::SelfCheck check_idle(base::ScanIndex first, std::span<const double> raw,
                                        const daq::Calibration& calibration, double scan_rate_Hz,
                                        const std::optional<daq::RateEstimate>& rate = {});

/// Six parameters are fitted; with ten times as many scans a standard error is known to a tenth.
inline constexpr std::size_t kFewestIdleScans = 60;
/// 50 and 60 Hz beat in 0.1 s: what is shorter cannot tell them apart.
inline constexpr double kShortestIdle_s = 0.15;

/// The latest idle scans. Thread-bound, allocates.
class IdleScans {
 public:
  /// As long as the drift needs, and no more than a record should carry.
  static constexpr double kKept_s = 5.0;
  static constexpr std::size_t kMostScans = 8192;

  explicit IdleScans(double scan_rate_Hz) noexcept;

  /// A jump of the index, as any clear(), begins anew.
  void add(base::ScanIndex index, double raw);
  void clear() noexcept { scans_.clear(); }

  /// Nothing if there are none.
  [[nodiscard]] std::optional<daq::SelfCheck> check(const daq::Calibration& calibration,
                                                    const std::optional<daq::RateEstimate>& rate) const;

 private:
  double scan_rate_Hz_;
  std::size_t most_;
  base::ScanIndex end_ = 0;
  std::deque<double> scans_;
};

}  // namespace stickslip::pipeline
