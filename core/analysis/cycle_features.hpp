/// \file
/// S − K, S and K of stick-slip from features of single cycles: from amplitudes [Penner 1995, (17)], from
/// periods, from the fastest slip [(18)], and K from the mean, corrected for the bias by damping. Each uses
/// other scans than the next, so that they check the fit of the whole trace and one another.
#pragma once

#include <span>
#include <string>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Fewest cycles from stick to stick that give a scatter.
inline constexpr std::size_t kFewestFeatureCycles = 3;

/// Fills delta_mu_from_amplitude, delta_mu_from_timing, delta_mu_from_slip_speed, delta_mu_combined,
/// mu_k_from_mean and mu_s_from_amplitude, or the reason why they are absent: no sticking, too few cycles, no
/// inverse. Leaves out the first slip unless estimates.first_counts. Standard errors combine the scatter from
/// cycle to cycle with the uncertainty of ω, γ and r.
/// \param estimates  of these slips; model_describes() must hold.
void feature_results(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                     const SlipEstimates& estimates, TestResults& results);

/// Sets all of these results to absent, with this reason.
void no_feature_results(const std::string& reason, TestResults& results);

}  // namespace stickslip::analysis
