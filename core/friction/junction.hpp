/// \file
/// Between two peaks of the force: did the sled stick, or did the oscillation go on freely?
#pragma once

#include <cstddef>

#include "core/friction/slip_model.hpp"
#include "core/friction/trace.hpp"

namespace stickslip::friction {

/// Standard deviation of ln(S − K) of paper at most: √ln(1 + 0.6²), for a scatter of 60 %.
inline constexpr double kDeltaMuLogScatter = 0.5545;

/// Log of the generalised likelihood ratio of "captured" over "continues free" on scans
/// [first, end), which reach from one maximum of the force to the minimum after the next.
///
/// Free: one decaying oscillation about one K (three parameters). Captured: the same until
/// c′ = r (at the end of the rise of c′ if it does not get there), stick at rate r to a new
/// S ≥ K, then a second slip with the same K (four parameters). After sticking the next amplitude
/// cannot be below r/ω, and below it a free oscillation cannot reach c′ = r: that is what decides
/// close to the threshold. [Penner 1995, (20)–(22)]
/// A capture that slips at once again, with S hardly above K, looks like no capture at all; so S − K of the
/// next slip is expected to be log-normal about what is typical of the test. \param shared  ω, γ and r, held
/// fixed. \param sigma noise of one scan. \param typical_delta_mu  S − K of the test's slips, roughly; > 0.
/// \return > 0 for captured; 0 if there are fewer than eight usable scans.
[[nodiscard]] double capture_log_likelihood_ratio(const Trace& trace, std::size_t first, std::size_t end,
                                                  const SharedParameters& shared, double sigma,
                                                  double typical_delta_mu);

}  // namespace stickslip::friction
