#include "core/friction/tier_means.hpp"

#include <cmath>

namespace stickslip::friction {

void TierMeans::Mean::add(double value) noexcept {  // [Welford, Technometrics 4(3):419–420, 1962]
  count += 1.0;
  const double off = value - mean;
  mean += off / count;
  square_sum += off * (value - mean);
}

Estimate TierMeans::Mean::estimate() const {
  if (count < 1.0) return Estimate::none("no cycle with an estimate of its own");
  if (count < 2.0) return Estimate::of(mean);
  return Estimate::of(mean, std::sqrt(square_sum / (count - 1.0) / count));
}

void TierMeans::add(const LiveCycle& cycle) noexcept {
  if (!std::isfinite(cycle.S) || !std::isfinite(cycle.K)) return;
  if (leaves_out_first_ && (cycle.cycle.flags & kCycleIsFirst) == 0 && only_first_) {
    S_ = K_ = delta_mu_ = Mean{};
    only_first_ = false;
  }
  S_.add(cycle.S);
  K_.add(cycle.K);
  delta_mu_.add(cycle.S - cycle.K);
}

void TierMeans::fill(TestResults& results) const {
  results.mu_s = S_.estimate();
  results.mu_k = K_.estimate();
  results.delta_mu = delta_mu_.estimate();
  if (delta_mu_.count >= 3.0) {
    const double variance = delta_mu_.square_sum / (delta_mu_.count - 1.0);
    results.delta_mu_scatter =
        Estimate::of(std::sqrt(variance), std::sqrt(variance / (2.0 * (delta_mu_.count - 1.0))));
  } else {
    results.delta_mu_scatter = Estimate::none("fewer than three slips to compare");
  }
}

}  // namespace stickslip::friction
