/// \file
/// Self-check of the unloaded tester. Noise, hum, spikes, saturation, zero and its drift are judged from
/// unloaded scans; the scan rate from all scans since the acquisition began.
///
///     const daq::SelfCheck check = check_idle(990, raw, calibration, 350.0);
///     for (const base::Finding& finding : self_check_findings(check, 22.9, 350.0)) …
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/base/finding.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/rate_fit.hpp"
#include "core/daq/self_check_values.hpp"

namespace stickslip::pipeline {

/// Checks unloaded scans: fits a straight line with sine and cosine of 50 and of 60 Hz to the forces, spikes
/// replaced, by least squares. Depends on its arguments only: a record gives the same bits again.
/// \param raw  consecutive scans from `first` on. With fewer than kFewestIdleScans, or less than
///        kShortestIdle_s, zero, drift, noise, hum and spikes are absent. Hum is absent, too, if the scan
///        rate cannot resolve 60 Hz (analysis::kLowestRateForHum_Hz).
/// \param scan_rate_Hz  granted.
/// \param rate  measured over all scans so far; nullopt if unknown.
[[nodiscard]] daq::SelfCheck check_idle(base::ScanIndex first, std::span<const double> raw,
                                        const daq::Calibration& calibration, double scan_rate_Hz,
                                        const std::optional<daq::RateEstimate>& rate = {});

/// Findings of a self-check, from its values and not from its `findings`.
/// \param normal_load_N  weight of the sled. \param scan_rate_Hz  granted.
[[nodiscard]] std::vector<base::Finding> self_check_findings(const daq::SelfCheck& check,
                                                             double normal_load_N, double scan_rate_Hz);

/// Fewest scans for zero, drift, noise, hum and spikes: ten for each of the six parameters, so that a
/// standard error is known to 10 %.
inline constexpr std::size_t kFewestIdleScans = 60;
/// Shortest time that they must last: one and a half beats of 50 and 60 Hz (0.1 s), which tells them apart.
inline constexpr double kShortestIdle_s = 0.15;

/// Buffer of the latest idle scans. Thread-bound, allocates.
class IdleScans {
 public:
  /// Length of the buffer, but at most kMostScans: enough for the drift, and small enough for a record.
  static constexpr double kKept_s = 5.0;
  static constexpr std::size_t kMostScans = 8192;

  explicit IdleScans(double scan_rate_Hz) noexcept;

  /// Adds a scan. A jump of the index clears the buffer first.
  void add(base::ScanIndex index, double raw);
  void clear() noexcept { scans_.clear(); }

  /// check_idle() of the buffered scans; nullopt if there are none.
  [[nodiscard]] std::optional<daq::SelfCheck> check(const daq::Calibration& calibration,
                                                    const std::optional<daq::RateEstimate>& rate) const;

 private:
  double scan_rate_Hz_;
  std::size_t most_;
  base::ScanIndex end_ = 0;
  std::deque<double> scans_;
};

}  // namespace stickslip::pipeline
