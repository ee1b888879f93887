/// \file
/// S − K, S and K of stick-slip from features of single cycles: from amplitudes [Penner 1995, (17)], from
/// periods, from the fastest slip [(18)], and K from the mean, corrected for the bias by damping. Onsets, ω,
/// γ and r are those of the fit of the whole trace. The features check that fit and one another.
#pragma once

#include <span>
#include <string>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Fewest cycles from stick to stick for which feature_results() gives values.
inline constexpr std::size_t kFewestFeatureCycles = 3;

/// Fills delta_mu_from_amplitude, delta_mu_from_timing, delta_mu_from_slip_speed, delta_mu_combined,
/// mu_k_from_mean and mu_s_from_amplitude. S and K include the drift. Uses the cycles without a gap and with
/// enough scans that begin and end in sticking; leaves out the first slip unless estimates.first_counts.
/// Standard errors combine the scatter from cycle to cycle with the uncertainty of ω, γ and r.
///
/// All are absent, with the reason, if no slip stuck again, there are fewer than kFewestFeatureCycles cycles,
/// results.delta_mu is not positive, γ is negative, or a feature has no inverse, as near the threshold.
/// delta_mu_combined alone is absent if amplitude, period or slip speed does not scatter at all.
/// \param estimates  of these slips, with a constant belt; model_describes() must hold.
/// \param results  delta_mu is read: call model_results() first.
void feature_results(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                     const SlipEstimates& estimates, TestResults& results);

/// Sets the results that feature_results() fills to absent, with this reason.
void no_feature_results(const std::string& reason, TestResults& results);

}  // namespace stickslip::analysis
