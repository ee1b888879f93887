/// \file
/// Do the slips of a test differ by more than noise? If not, one S and one K tell more.
#pragma once

#include <optional>
#include <vector>

#include "core/estimate/slip_fit.hpp"
#include "core/estimate/uniform_fit.hpp"

namespace stickslip::estimate {

/// Probability with which slips that do not differ are taken to differ. That costs certainty only: then the
/// fit slip by slip stays, which is right in either case. One in a hundred tests with three times the
/// variance adds 1 % to the rms error.
inline constexpr double kScatterLevel = 0.01;

/// Fits one course to all slips but the first, which is often not representative [Penner 1995] (or, if
/// `first_counts`, to all), and compares it with the fit slip by slip of the same scans by an F test on the
/// robust costs: 3n + 3 parameters against 6 [Hampel et al., Robust Statistics, 1986, section 7.2]. \param
/// windows,shared  fitted by fit_slips() to the whole test. \return nothing if a slip did not end in
/// sticking, there are fewer than three, the fit does not converge,
///         or the slips differ significantly.
[[nodiscard]] std::optional<UniformFit> uniform_if_slips_agree(const Trace& trace,
                                                               const std::vector<SlipWindow>& windows,
                                                               const model::SharedParameters& shared,
                                                               double sigma, const SharedPrior& prior,
                                                               bool first_counts = false);

}  // namespace stickslip::estimate
