/// \file
/// Maximum-likelihood fit of one S and one K, with ω, γ and the stick rate, to all slips of a pull: six
/// numbers instead of three for each slip. Where the paper does not scatter it reaches the Cramér–Rao bound
/// (core/estimate/information), which the fit slip by slip cannot: there the times of onsets and captures
/// do not tell about S, K and γ.
#pragma once

#include <cstddef>

#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/uniform_course.hpp"

namespace stickslip::estimate {

struct UniformFit {
  bool converged = false;
  model::UniformParameters parameters;
  model::UniformParameters::Matrix covariance = model::UniformParameters::Matrix::Zero();
  double residual_sigma = 0.0;  ///< Standard deviation of a scan about the course.
  double cost = 0.0;            ///< Huber's, of scans and prior.
  double scan_count = 0.0;      ///< Usable scans.
};

/// Levenberg–Marquardt with Huber's weights, as fit_slips().
/// \param first,end  scans of the pull. \param guess first guess; its course must exist.
/// \param sigma  noise of one scan, > 0.
[[nodiscard]] UniformFit fit_uniform(const Trace& trace, std::size_t first, std::size_t end,
                                     const model::UniformParameters& guess, double sigma,
                                     const SharedPrior& prior);

}  // namespace stickslip::estimate
