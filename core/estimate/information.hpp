/// \file
/// Cramér–Rao bound of the closed-form model: the smallest possible standard errors of a test's parameters.
/// [Rao, Bull. Calcutta Math. Soc. 37:81–91, 1945; Cramér, Mathematical Methods of Statistics, 1946, 32.3]
///
///     const UniformParameters::Matrix scans = fisher_information(course, times_s, 0.001);
///     const UniformBounds best = cramer_rao_bounds(parameters, scans, prior);
#pragma once

#include <span>

#include "core/estimate/shared_prior.hpp"
#include "core/model/uniform_trajectory.hpp"

namespace stickslip::estimate {

/// Fisher information about (onset, S, K, ω, γ, r), Σ J Jᵀ/σ², in scans with white Gaussian noise.
/// \param times_s  of the scans.
/// \param sigma  noise of one scan, > 0.
[[nodiscard]] model::UniformParameters::Matrix fisher_information(const model::UniformTrajectory& course,
                                                                  std::span<const double> times_s,
                                                                  double sigma);

/// Bound for one free oscillation after a slip onset, with onset, S, K and stick rate unknown.
/// \param times_s  of the scans, which must determine all six parameters.
/// \param sigma  noise of one scan, > 0.
/// \return smallest covariance of (ω, γ/2ω).
[[nodiscard]] Eigen::Matrix2d ring_down_bound(const model::SharedParameters& shared,
                                              const model::SlipParameters& slip,
                                              std::span<const double> times_s, double sigma);

/// Smallest standard errors of an unbiased estimate.
struct UniformBounds {
  double S = 0.0;
  double K = 0.0;
  double delta_mu = 0.0;
  double omega = 0.0;  ///< rad/s
  double gamma_over_2omega = 0.0;
};

/// Cramér–Rao bounds of periodic stick-slip. Scans and prior together must determine all six parameters.
/// \param information  fisher_information() of the scans.
/// \param prior  adds its information; may be empty.
[[nodiscard]] UniformBounds cramer_rao_bounds(const model::UniformParameters& parameters,
                                              const model::UniformParameters::Matrix& information,
                                              const SharedPrior& prior);

}  // namespace stickslip::estimate
