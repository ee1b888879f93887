#include "core/analysis/tier_means.hpp"

#include <cmath>

namespace stickslip::analysis {

namespace {

Estimate estimate_of(const signal::RunningVariance& values) {
  if (values.count < 1.0) return Estimate::none("no cycle with an estimate of its own");
  if (values.count < 2.0) return Estimate::of(values.mean);
  return Estimate::of(values.mean, values.error_of_mean());
}

}  // namespace

void TierMeans::add(const detect::LiveCycle& cycle) noexcept {
  if (!std::isfinite(cycle.S) || !std::isfinite(cycle.K)) return;
  if (leaves_out_first_ && (cycle.cycle.flags & detect::kCycleIsFirst) == 0 && only_first_) {
    S_ = K_ = delta_mu_ = {};
    only_first_ = false;
  }
  S_.add(cycle.S);
  K_.add(cycle.K);
  delta_mu_.add(cycle.S - cycle.K);
}

void TierMeans::fill(TestResults& results) const {
  results.mu_s = estimate_of(S_);
  results.mu_k = estimate_of(K_);
  results.delta_mu = estimate_of(delta_mu_);
  if (delta_mu_.count >= 3.0) {
    const double variance = delta_mu_.variance();
    results.delta_mu_scatter =
        Estimate::of(std::sqrt(variance), std::sqrt(variance / (2.0 * (delta_mu_.count - 1.0))));
  } else {
    results.delta_mu_scatter = Estimate::none("fewer than three slips to compare");
  }
}

}  // namespace stickslip::analysis
