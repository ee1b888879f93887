/// \file
/// Tests whether the slips of a test differ by more than noise; if not, fits one S and one K to all of them.
#pragma once

#include <optional>
#include <vector>

#include "core/estimate/slip_fit.hpp"
#include "core/estimate/uniform_fit.hpp"

namespace stickslip::estimate {

/// Significance level of the F test: the probability that slips with equal S and K are taken to differ. Such
/// an error costs precision only: the fit slip by slip is then used, which is valid in either case. Three
/// times the variance in one of a hundred tests adds 1 % to the rms error.
inline constexpr double kScatterLevel = 0.01;

/// Fits periodic stick-slip to all slips but the first, which is often not representative [Penner 1995], and
/// compares it with the fit slip by slip, by an F test on the robust costs, 3n + 3 parameters for n slips
/// against 6 [Hampel et al., Robust Statistics, 1986, section 7.2].
/// \param trace  of a belt of constant speed.
/// \param windows,shared  fitted by fit_slips() to the whole test, or to a section of a long one.
/// \param sigma  noise of one scan, > 0.
/// \param first_counts  the first slip is fitted too.
/// \return the fit of one S and one K; nullopt if a window is not SlipWindow::captured, there are fewer than
/// three windows, no periodic stick-slip has the slips' means, either fit does not converge, or the slips
/// differ significantly.
[[nodiscard]] std::optional<UniformFit> uniform_if_slips_agree(const Trace& trace,
                                                               const std::vector<SlipWindow>& windows,
                                                               const model::SharedParameters& shared,
                                                               double sigma, const SharedPrior& prior,
                                                               bool first_counts = false);

}  // namespace stickslip::estimate
