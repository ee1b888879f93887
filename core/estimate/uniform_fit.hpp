/// \file
/// Maximum-likelihood fit of periodic stick-slip to a pull: one onset, S, K, ω, γ and stick rate for all
/// slips, six parameters instead of three for each slip. Where the paper does not scatter it reaches the
/// Cramér–Rao bound (core/estimate/information) but for the 5 % that Huber's weights cost. The fit slip by
/// slip cannot, since it takes no information about S, K and γ from the times of onsets and captures.
#pragma once

#include <cstddef>

#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/uniform_trajectory.hpp"

namespace stickslip::estimate {

/// Result of fit_uniform(). Unless it converged, its members are no estimates.
struct UniformFit {
  bool converged = false;
  model::UniformParameters parameters;  ///< S and K without Trace::drift.
  /// Of (onset, S, K, ω, γ, r).
  model::UniformParameters::Matrix covariance = model::UniformParameters::Matrix::Zero();
  double residual_sigma = 0.0;  ///< Scans about the trajectory: σ times HuberSums::residual_sigma().
  double cost = 0.0;            ///< Huber's, of scans and prior.
  double scan_count = 0.0;      ///< Usable scans.
};

/// Fits periodic stick-slip with Huber's weights to the usable scans of a pull at constant speed.
/// \param first,end  scans [first, end) of the pull.
/// \param guess  first guess; UniformTrajectory::make() must accept it.
/// \param sigma  noise of one scan, > 0.
/// \param prior  of ω, γ and stick rate.
/// \return converged = false if the fit does not settle in 60 iterations, or if scans and prior do not
/// determine the parameters.
[[nodiscard]] UniformFit fit_uniform(const Trace& trace, std::size_t first, std::size_t end,
                                     const model::UniformParameters& guess, double sigma,
                                     const SharedPrior& prior);

}  // namespace stickslip::estimate
