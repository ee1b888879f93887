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

/// Result of escape_speeds().
struct EscapeSpeeds {
  Estimate first_escape;   ///< m/s: pull speed at the onset of the first slip that did not stick again.
  Estimate of_mean_paper;  ///< m/s: threshold speed for the mean of S − K.
};

/// Threshold speed of the mean paper, from captured and escaped slips. Model: the S − K of a slip, and so its
/// threshold speed, is log-normal with the relative scatter `scatter`. of_mean_paper is the mean over the
/// likelihood. Its standard error is the likelihood's standard deviation, combined with the effect of the
/// scatter's own error, scatter/√(2(n − 1)) for n trials. Between the fastest captured slip and the slowest
/// escape above it the speed is not resolved: the variance of a uniform distribution over that interval is
/// added to the scatter. first_escape has no standard error.
///
/// Both are absent, with the reason, if no slip escaped or none stuck before the first escape; of_mean_paper
/// also if the scatter is 0 and no escape is faster than all captured slips.
/// \param trials  in the order of time.
/// \param scatter  standard deviation over mean of S − K, ≥ 0.
[[nodiscard]] EscapeSpeeds escape_speeds(std::span<const EscapeTrial> trials, double scatter);

/// Trials of a test on a belt whose speed changes, in the order of time. Empty on a constant belt or if
/// γ ≤ 0. Slips just before the belt stops are left out: no speed decides there.
/// \param estimates  converged.
[[nodiscard]] std::vector<EscapeTrial> escape_trials(const SlipEstimates& estimates);

/// Relative scatter of S − K over the slips that began from sticking: standard deviation over mean. The
/// variance that the noise of the scans contributes is subtracted; 0 if it is larger than that found.
/// \param estimates  converged.
/// \return nullopt for fewer than three slips, or if the mean is not positive.
[[nodiscard]] std::optional<double> delta_mu_scatter(const SlipEstimates& estimates);

}  // namespace stickslip::analysis
