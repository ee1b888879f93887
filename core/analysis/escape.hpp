/// \file
/// Escape speed of a ramp test, and the threshold speed estimated from it. [Penner 1995, future work]
///
/// The first slip that does not stick again is the first failure among many cycles. Where S − K scatters from
/// slip to slip it comes long before the threshold speed v_th of the mean paper: at 0.84 v_th on a ramp of
/// 150 cycles with a scatter of 10 %. The slips give both the scatter and the speed of each, so the bias can
/// be corrected: v_th is estimated from the likelihood of "captured at v₁ … v_n, escaped at v_(n+1)".
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"

namespace stickslip::analysis {

/// One slip that began from sticking and whose end, captured or free, is known.
struct EscapeTrial {
  double onset_speed_m_per_s = 0.0;
  /// Threshold speed, at steady speed, of the smallest S − K that would have been captured here. This slip
  /// was captured if its own threshold speed is higher. On an accelerating belt it exceeds the speed at the
  /// onset, since the sled must reach the belt's speed three quarters of a period later.
  double critical_speed_m_per_s = 0.0;
  bool captured = false;
};

struct EscapeSpeeds {
  Estimate first_escape;   ///< m/s: pull speed at the onset of the first slip that did not stick again.
  Estimate of_mean_paper;  ///< m/s: threshold speed for the mean of S − K.
};

/// Estimates the threshold speed as the mean over the likelihood. Model: S − K is log-normal with this
/// relative scatter, and so is each slip's threshold speed, which is proportional to it. The interval between
/// the speed of the last captured slip and that of the first escape above it is not resolved; the variance of
/// a uniform distribution over it is added to the scatter. The standard error is that of the curvature,
/// combined with the effect of the scatter's own error, scatter/√(2(n − 1)).
/// \param trials  in the order of time.
/// \param scatter  standard deviation over mean of S − K, ≥ 0.
[[nodiscard]] EscapeSpeeds escape_speeds(std::span<const EscapeTrial> trials, double scatter);

/// Trials of a test on a belt whose speed changes. \param estimates  converged, with γ > 0.
[[nodiscard]] std::vector<EscapeTrial> escape_trials(const SlipEstimates& estimates);

/// Relative scatter of S − K from slip to slip: standard deviation over mean, less the contribution of the
/// scans' noise.
/// \return nullopt for fewer than three slips, or if the mean is not positive.
[[nodiscard]] std::optional<double> delta_mu_scatter(const SlipEstimates& estimates);

}  // namespace stickslip::analysis
