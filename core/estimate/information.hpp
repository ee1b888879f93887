/// \file
/// How well a test can be known at all: the Cramér–Rao bound of the closed-form model.
/// [Rao, Bull. Calcutta Math. Soc. 37:81–91, 1945; Cramér, Mathematical Methods of Statistics, 1946, 32.3]
///
///     const UniformParameters::Matrix scans = fisher_information(course, times_s, 0.001);
///     const UniformBounds best = cramer_rao_bounds(parameters, scans, prior);
#pragma once

#include <span>

#include "core/estimate/shared_prior.hpp"
#include "core/model/uniform_course.hpp"

namespace stickslip::estimate {

/// Σ J Jᵀ/σ²: what scans with white Gaussian noise tell about (onset, S, K, ω, γ, r).
/// \param sigma  noise of one scan, > 0.
[[nodiscard]] model::UniformParameters::Matrix fisher_information(const model::UniformCourse& course,
                                                                  std::span<const double> times_s,
                                                                  double sigma);

/// What the scans of one free oscillation after a slip onset tell about (ω, γ/2ω), with its onset, S, K
/// and stick rate unknown. \return covariance of (ω, γ/2ω) at the bound.
[[nodiscard]] Eigen::Matrix2d ring_down_bound(const model::SharedParameters& shared,
                                              const model::SlipParameters& slip,
                                              std::span<const double> times_s, double sigma);

/// Least standard errors of an estimate without bias.
struct UniformBounds {
  double S = 0.0;
  double K = 0.0;
  double delta_mu = 0.0;
  double omega = 0.0;
  double gamma_over_2omega = 0.0;
};

/// \param information  of the scans. \param prior adds what is known beforehand, none if empty.
[[nodiscard]] UniformBounds cramer_rao_bounds(const model::UniformParameters& parameters,
                                              const model::UniformParameters::Matrix& information,
                                              const SharedPrior& prior);

}  // namespace stickslip::estimate
