/// \file
/// Maximum-likelihood fit of periodic stick-slip to a pull: one onset, S, K, ω, γ and stick rate for all
/// slips, six parameters instead of three for each slip. Where the paper does not scatter it reaches the
/// Cramér–Rao bound (core/estimate/information). The fit slip by slip cannot, since it takes no information
/// about S, K and γ from the times of onsets and captures.
#pragma once

#include <cstddef>

#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/uniform_trajectory.hpp"

namespace stickslip::estimate {

/// Result of fit_uniform().
struct UniformFit {
  bool converged = false;
  model::UniformParameters parameters;
  model::UniformParameters::Matrix covariance = model::UniformParameters::Matrix::Zero();
  double residual_sigma = 0.0;  ///< Standard deviation of a scan about the trajectory.
  double cost = 0.0;            ///< Huber's, of scans and prior.
  double scan_count = 0.0;      ///< Usable scans.
};

/// Least cost with Huber's weights, as fit_slips().
/// \param first,end  scans of the pull. \param guess first guess; UniformTrajectory::make() must accept it.
/// \param sigma  noise of one scan, > 0.
[[nodiscard]] UniformFit fit_uniform(const Trace& trace, std::size_t first, std::size_t end,
                                     const model::UniformParameters& guess, double sigma,
                                     const SharedPrior& prior);

}  // namespace stickslip::estimate
