#include "core/analysis/tier_means.hpp"

#include <algorithm>
#include <cmath>

#include "core/analysis/ladder.hpp"

namespace stickslip::analysis {

namespace {

/// \param level  peak or middle of the same cycles: the mean is at least as uncertain as theirs.
Estimate estimate_of(const signal::WanderingMean& values, const signal::WanderingMean& level,
                     double systematic_uncertainty) {
  if (values.count() < 1.0) return Estimate::none("no cycle with an estimate of its own");
  Estimate estimate =
      values.count() < 2.0
          ? Estimate::of(values.mean())
          : Estimate::of(values.mean(), std::max(values.error_of_mean(), level.error_of_mean()));
  add_systematic(estimate, UncertaintySource::kCorrection, systematic_uncertainty);
  return estimate;
}

}  // namespace

void TierMeans::add(const detect::LiveCycle& cycle) noexcept {
  if (!std::isfinite(cycle.S) || !std::isfinite(cycle.K)) return;
  if (leaves_out_first_ && (cycle.cycle.flags & detect::kCycleIsFirst) == 0 && only_first_) {
    S_ = K_ = delta_mu_ = {};
    S_correction_ = K_correction_ = {};
    only_first_ = false;
  }
  S_.add(cycle.S);
  K_.add(cycle.K);
  delta_mu_.add(cycle.S - cycle.K);
  S_correction_.add(cycle.S - cycle.cycle.peak);
  K_correction_.add(cycle.K - 0.5 * (cycle.cycle.peak + cycle.cycle.trough));
}

void TierMeans::add_level(double peak, double trough) noexcept {
  if (levels_++ == 1 && leaves_out_first_) peak_ = middle_ = {};
  peak_.add(peak);
  middle_.add(0.5 * (peak + trough));
}

void TierMeans::fill(TestResults& results) const {
  const double of_S = std::abs(S_correction_.mean);
  const double of_K = std::abs(K_correction_.mean);
  results.mu_s = estimate_of(S_, peak_, of_S);
  results.mu_k = estimate_of(K_, middle_, of_K);
  results.delta_mu = estimate_of(delta_mu_, delta_mu_, of_S + of_K);
  if (results.delta_mu.value && *results.delta_mu.value <= 0.0 && of_S + of_K > 0.0) {
    // The amplitude is that of the belt's speed alone.
    tell_bound(of_S + of_K, results);
  }
  if (delta_mu_.count() >= 3.0) {
    const double variance = delta_mu_.variance();
    results.delta_mu_scatter =
        Estimate::of(std::sqrt(variance), std::sqrt(variance / (2.0 * (delta_mu_.count() - 1.0))));
  } else {
    results.delta_mu_scatter = Estimate::none("fewer than three slips to compare");
  }
}

}  // namespace stickslip::analysis
