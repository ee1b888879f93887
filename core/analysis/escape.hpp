/// \file
/// At which speed does the sled escape, on a pull whose speed changes? [Penner 1995, future work]
///
/// The first slip that does not stick again is the first failure of many cycles: with S − K that scatters
/// from slip to slip it comes long before the threshold speed v_th of the mean paper — at 0.84 v_th on a ramp
/// of 150 cycles with a scatter of 10 %. The scatter is known from the slips themselves, and so is the speed
/// of each, so that the bias can be taken off: v_th is where "captured at v₁ … v_n, escaped at v_(n+1)" is
/// likeliest.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"

namespace stickslip::analysis {

/// One slip that began from sticking and whose end is known.
struct EscapeTrial {
  double onset_speed_m_per_s = 0.0;
  /// The steady speed at which the least S − K that would have been captured here is critical: what the
  /// threshold speed of this slip is compared with. On a belt that speeds up it is above the speed at the
  /// onset, since the sled has to catch up with the belt three quarters of a period later.
  double critical_speed_m_per_s = 0.0;
  bool captured = false;
};

struct EscapeSpeeds {
  Estimate first_escape;   ///< m/s: pull speed at the onset of the first slip that did not stick again.
  Estimate of_mean_paper;  ///< m/s: threshold speed for the mean of S − K.
};

/// Mean over the likelihood, for S − K that is log-normal with this relative scatter, and with it each slip's
/// own threshold speed, which is proportional to it. What of the speed lies between the last captured slip
/// and the first above it that escaped cannot be told: its variance, a uniform distribution's, is added to
/// the scatter. The standard error is that of the curvature, with what the scatter's own error (scatter/√(2(n
/// − 1))) adds. \param trials  in the order of time. \param scatter  standard deviation over mean of S − K, ≥
/// 0.
[[nodiscard]] EscapeSpeeds escape_speeds(std::span<const EscapeTrial> trials, double scatter);

/// The slips of a test on a belt whose speed changes. \param estimates  converged, with γ > 0.
[[nodiscard]] std::vector<EscapeTrial> escape_trials(const SlipEstimates& estimates);

/// Standard deviation over mean of S − K from slip to slip, without what the noise of the scans adds to it.
/// \return nothing from fewer than three slips, or if the mean is not positive.
[[nodiscard]] std::optional<double> delta_mu_scatter(const SlipEstimates& estimates);

}  // namespace stickslip::analysis
