/// \file
/// S − K, S and K as the paper would take them from stick-slip: from amplitudes [Penner 1995, (17)], from
/// periods, from the fastest slip [(18)], and K from the mean, without the bias that damping gives it. Each
/// looks at other scans than the next, so that they check the fit of the whole trace and one another.
#pragma once

#include <span>
#include <string>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Cycles from stick to stick that are needed for a scatter.
inline constexpr std::size_t kFewestFeatureCycles = 3;

/// Fills delta_mu_from_amplitude, delta_mu_from_timing, delta_mu_from_slip_speed, delta_mu_combined,
/// mu_k_from_mean and mu_s_from_amplitude, or the reason why there are none: no sticking seen, too few
/// cycles, no inverse. The first slip does not count, unless estimates.first_counts. Standard errors hold the
/// scatter from cycle to cycle and what ω, γ and r are uncertain by. \param estimates  model_describes(); of
/// these slips.
void feature_results(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                     const SlipEstimates& estimates, TestResults& results);

/// The same reason for all of them.
void no_feature_results(const std::string& reason, TestResults& results);

}  // namespace stickslip::analysis
