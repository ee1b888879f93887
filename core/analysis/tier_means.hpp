/// \file
/// S, K and S − K of a test from those of its cycles, for the estimators that know cycles alone.
#pragma once

#include "core/analysis/results.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {

/// Means over cycles in a fixed memory. The first — often not representative [Penner 1995] — counts only if
/// there is no other, or if it is kept.
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
