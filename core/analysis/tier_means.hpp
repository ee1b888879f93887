/// \file
/// S, K and S − K of a test as means over its cycles, for the estimator tiers without a whole-test fit.
#pragma once

#include "core/analysis/results.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {

/// Running means over cycles, in fixed memory. The first cycle, often not representative [Penner 1995], is
/// left out if there are others, unless first_counts.
class TierMeans {
 public:
  explicit TierMeans(bool first_counts = false) noexcept : leaves_out_first_(!first_counts) {}
  void add(const detect::LiveCycle& cycle) noexcept;
  /// mu_s, mu_k, delta_mu with standard errors from the scatter, and delta_mu_scatter.
  void fill(TestResults& results) const;

 private:
  signal::RunningVariance S_;
  signal::RunningVariance K_;
  signal::RunningVariance delta_mu_;
  bool leaves_out_first_;
  bool only_first_ = true;
};

}  // namespace stickslip::analysis
