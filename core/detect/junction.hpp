/// \file
/// Between two peaks of the force: did the sled stick, or did the oscillation go on freely?
#pragma once

#include <cstddef>

#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::detect {

/// Standard deviation of ln(S − K) of paper at most: √ln(1 + 0.6²), for a scatter of 60 %.
inline constexpr double kDeltaMuLogScatter = 0.5545;

/// Huber's limit for a choice. What tells two courses apart are residuals of several standard deviations of
/// the wrong one; the limit of an estimate would cut what they tell to a half (docs/detector.md).
inline constexpr double kChoiceLimit = 3.0;

/// By so much of itself the stick rate may be wrong that a loading and a slip or two have told. A capture
/// needs c′ = r (20): where the course does not get there, the shortfall over this is one residual more.
inline constexpr double kStickRateSpread = 0.01;

/// Of S − K to what is typical: keeps its logarithm finite.
inline constexpr double kLeastRatio = 1e-6;

/// Log of the generalised likelihood ratio of "captured" over "continues free" on scans
/// [first, end), which reach from one maximum of the force to the minimum after the next.
///
/// Free: one decaying oscillation about one K (three parameters). Captured: the same until
/// c′ = r (at the end of the rise of c′ if it does not get there, which is held against it), stick at rate r
/// to a new S ≥ K, then a second slip with the same K (four parameters). After sticking the next amplitude
/// cannot be below r/ω, and below it a free oscillation cannot reach c′ = r: that is what decides
/// close to the threshold. [Penner 1995, (20)–(22)]
/// A capture that slips at once again, with S hardly above K, looks like no capture at all; so S − K of the
/// next slip is expected to be log-normal about what is typical of the test. \param shared  ω, γ and r, held
/// fixed. \param sigma noise of one scan. \param typical_delta_mu  S − K of the test's slips, roughly; > 0.
/// \return > 0 for captured; 0 if there are fewer than eight usable scans.
[[nodiscard]] double capture_log_likelihood_ratio(const estimate::Trace& trace, std::size_t first,
                                                  std::size_t end, const model::SharedParameters& shared,
                                                  double sigma, double typical_delta_mu);

}  // namespace stickslip::detect
