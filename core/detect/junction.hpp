/// \file
/// Likelihood ratio of capture over free oscillation, from the scans between two peaks of the force.
#pragma once

#include <cstddef>

#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::detect {

/// Largest standard deviation of ln(S − K) from slip to slip: √ln(1 + 0.6²), for a scatter of 60 %.
inline constexpr double kDeltaMuLogScatter = 0.5545;

/// Huber's limit for the choice between two trajectories; for estimates it is estimate::kHuberLimit
/// (core/estimate/huber.hpp). The wrong trajectory has residuals of several standard deviations; the smaller
/// limit would halve the likelihood ratio (docs/detector.md).
inline constexpr double kChoiceLimit = 3.0;

/// Relative standard deviation of a stick rate estimated from a loading and one or two slips. A capture needs
/// c′ = r (20). If the largest c′ stays below r, the relative shortfall divided by this is one more residual.
inline constexpr double kStickRateSpread = 0.01;

/// Smallest ratio of S − K to its typical value; keeps the logarithm finite.
inline constexpr double kLeastRatio = 1e-6;

/// Log of the generalised likelihood ratio of "captured" over "free" for scans [first, end), from one maximum
/// of the force to the minimum after the next maximum.
///
/// Free: one decaying oscillation about one K (three parameters). Captured: the same until
/// c′ = r (at the end of the rise of c′ if it does not reach r, with the penalty of kStickRateSpread), stick
/// at rate r to a new S ≥ K, then a second slip with the same K (four parameters). After a stick the next
/// amplitude is at least r/ω, and a free oscillation of smaller amplitude cannot reach c′ = r; this decides
/// close to the threshold. [Penner 1995, (20)–(22)] A capture followed at once by a slip with S hardly above
/// K cannot be distinguished from a free oscillation. Therefore S − K of the next slip has a prior:
/// log-normal about the typical value of the test.
/// \param shared  ω, γ and r, held fixed.
/// \param sigma  noise of one scan.
/// \param typical_delta_mu  typical S − K of the test's slips, > 0.
/// \return > 0 for captured; 0 if there are fewer than eight usable scans.
[[nodiscard]] double capture_log_likelihood_ratio(const estimate::Trace& trace, std::size_t first,
                                                  std::size_t end, const model::SharedParameters& shared,
                                                  double sigma, double typical_delta_mu);

}  // namespace stickslip::detect
