/// \file
/// S, K and S − K of a test as means over its cycles, by turning points.
#pragma once

#include "core/analysis/results.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/signal/wandering_mean.hpp"

namespace stickslip::analysis {

/// Means of S, K and S − K over cycles, in fixed memory. Those with kCycleIsFirst at the beginning, often not
/// representative [Penner 1995], are left out if others follow, unless first_counts.
class TierMeans {
 public:
  explicit TierMeans(bool first_counts = false) noexcept : leaves_out_first_(!first_counts) {}
  /// The next cycle; one without S or K is ignored.
  void add(const detect::LiveCycle& cycle) noexcept;
  /// Peak and trough of the next slip, also of one without S and K. The standard errors of S and K are at
  /// least those of the mean peak and the mean middle of peak and trough, without the first slip as above.
  void add_level(double peak, double trough) noexcept;
  /// Fills mu_s, mu_k, delta_mu and delta_mu_scatter; absent without a cycle, the scatter with fewer than
  /// three. Standard errors follow from the scatter of the cycles, of which neighbours are correlated; one
  /// cycle has none. The systematic uncertainty is the whole correction for belt and damping: no fit has
  /// shown that the closed forms hold. An S − K that is not above zero is replaced by half of that
  /// correction, unless that is 0, as by tell_bound(), and Q and threshold_speed become absent.
  void fill(TestResults& results) const;

 private:
  signal::WanderingMean S_;
  signal::WanderingMean K_;
  signal::WanderingMean delta_mu_;
  // What wanders along the track is seen best in all slips, without corrections that scatter.
  signal::WanderingMean peak_;
  signal::WanderingMean middle_;
  // What S and K owe to belt and damping beside the peak and the middle of the fall.
  signal::RunningMean S_correction_;
  signal::RunningMean K_correction_;
  bool leaves_out_first_;
  bool only_first_ = true;
  int levels_ = 0;
};

}  // namespace stickslip::analysis
