/// \file
/// Live detector: present phase and regime of a test, and each cycle as it closes.
///
///     LiveDetector detector{settings};
///     for (…) if (const auto cycle = detector.add(coefficient, saturated)) use(*cycle);
///     if (const auto last = detector.end()) use(*last);
///
/// Results depend on scans, gaps and settings, not on the division into blocks. O(1) for a scan. The fits of
/// a closing cycle have bounded size and are distributed over scans. Allocates only in the constructor.
///
/// A fall is reported kFallDelayScans, or without despiking one scan, after the scan at which the median of
/// three scans has fallen below its maximum by the hysteresis. If the highest scan is isolated, the median's
/// maximum is lower, and the scans themselves may have fallen by the hysteresis one scan earlier.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/detect/cycle_flags.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/detect/loading.hpp"
#include "core/detect/ring_down_watch.hpp"
#include "core/detect/scan_positions.hpp"
#include "core/detect/slip_follower.hpp"
#include "core/detect/slip_rule.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/signal/despike.hpp"
#include "core/signal/noise.hpp"

namespace stickslip::detect {

struct LiveSettings {
  double scan_rate_Hz = 350.0;    ///< Granted; > 0.
  double step_coefficient = 0.0;  ///< One A/D step; 0 if unknown.
  EstimatorTier estimator = EstimatorTier::kFit;
  estimate::SharedPrior prior;  ///< The tester's characterisation, if there is one; else empty.
  bool despike = true;          ///< false: spikes stay in the trace and are not looked for.
};

/// Follows a test scan by scan. Times are seconds after the first scan added, with the time of missing scans.
/// Thread-bound. 200 kB, taken when it is made.
class LiveDetector {
 public:
  /// Delay of a fall's report: three scans of the despiker and one of the median of three; without despiking
  /// one.
  static constexpr int kFallDelayScans = 4;

  explicit LiveDetector(const LiveSettings& settings);

  /// The next scan; the coefficient must be finite.
  /// \return the cycle that it closes, else nullopt. A cycle closes when the next slip is confirmed, at the
  /// rise after that slip's trough, or when its ring-down has died away. Cycle::first_scan counts from the
  /// first scan added, with missing scans.
  std::optional<LiveCycle> add(double coefficient, bool saturated);
  /// `count` > 0 scans are missing before the next one. Before the first scan this shifts all times.
  void gap(std::int64_t count) noexcept;
  /// The test is over. The scans that the despiker still holds back are not used.
  /// \return the last cycle, if one is open; else nullopt.
  std::optional<LiveCycle> end() noexcept;

  [[nodiscard]] const LiveState& state() const noexcept { return state_; }
  /// The fall detected at the latest scan, if any; none before the loading. Its scan numbers count from the
  /// first scan added, without missing scans.
  [[nodiscard]] const std::optional<FallBegun>& fall_begun() const noexcept { return fall_begun_; }
  /// The slip under way with its present estimates; null if there is none. Valid until the next add(), gap()
  /// or end(). Number, period_s, first_scan and flags of its scans are set when the cycle closes.
  [[nodiscard]] const LiveCycle* under_way() const noexcept {
    return follower_.is_open() ? &follower_.slip() : nullptr;
  }

 private:
  /// Scans that the despiker holds back.
  static constexpr std::int64_t kHeldBack = 3;

  std::optional<LiveCycle> follow(const signal::DespikedScan& scan, bool saturated);
  std::optional<LiveCycle> slip(const Fall& fall, double now_s) noexcept;
  void follow_gap() noexcept;
  void take_decision() noexcept;
  void watch_phase(double value, double sigma) noexcept;
  std::optional<LiveCycle> close() noexcept;
  /// Noise of the scans that tell how a slip ends. Spikes would add to it: 20 a second lie in a quarter of
  /// the fourth differences of 350 scans/s, whose median is 40 % larger then.
  [[nodiscard]] double usable_sigma() const noexcept {
    return usable_noise_.known() ? usable_noise_.sigma() : noise_.sigma();
  }

  LiveSettings settings_;
  signal::NoiseEstimator noise_;  ///< Of scans as they come: what despiker, finder and slip rule ask for.
  signal::NoiseEstimator usable_noise_;  ///< Of those that the follower keeps.
  signal::Despiker despiker_;
  std::array<bool, 4> saturated_{};  ///< Of the scans that the despiker still holds, and one.
  FallFinder finder_;
  SlipRule rule_;
  SlipFollower follower_;
  RingDownWatch watch_;
  LiveState state_;
  std::optional<FallBegun> fall_begun_;
  ScanPositions positions_;
  Loading loading_;
  CycleFlags flags_;
};

// Each scan goes through these: in the caller's loop.

inline std::optional<LiveCycle> LiveDetector::add(double coefficient, bool saturated) {
  noise_.add(coefficient);
  const std::int64_t before = positions_.come();
  saturated_[static_cast<std::size_t>(before) % saturated_.size()] = saturated;
  fall_begun_.reset();
  if (!settings_.despike) return follow({coefficient, false}, saturated);
  const auto scan = despiker_.add(coefficient, noise_.sigma());
  if (!scan) return std::nullopt;
  return follow(*scan, saturated_[static_cast<std::size_t>(before - kHeldBack) % saturated_.size()]);
}

}  // namespace stickslip::detect
