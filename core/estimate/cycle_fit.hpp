/// \file
/// Live maximum-likelihood fit of the closed form to the scans of one slip.
///
///     const CycleFit fit = fit_cycle(buffer.points(), true, start, shared, knowledge, sigma);
///
/// Six parameters with analytic derivatives and Huber's weights, as the fit of the whole test
/// (core/estimate/slip_fit); the present knowledge of ω, γ and r (SharedPosterior) enters as a
/// Gaussian prior. All matrices have fixed sizes; nothing is allocated.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/estimate/cycle_buffer.hpp"
#include "core/estimate/shared_posterior.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Result of fit_cycle(). Unless it converged, its members are no estimates.
struct CycleFit {
  bool converged = false;
  model::SlipParameters slip;
  model::SharedParameters shared;
  /// Of (onset, S, K), including the uncertainty of ω, γ and r; larger if the residuals exceed noise.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  SharedEvidence evidence;  ///< Information about ω, γ and r from these scans alone, without the prior.
  double capture_s = 0.0;   ///< SlipModel::capture_s(), after the onset; infinity with captured = false.
  double residual_sigmas = 0.0;  ///< HuberSums::residual_sigma().

  [[nodiscard]] double delta_mu() const noexcept { return slip.S - slip.K; }
  [[nodiscard]] double delta_mu_variance() const noexcept {
    return covariance(1, 1) + covariance(2, 2) - 2.0 * covariance(1, 2);
  }
};

/// Fits one slip. The speed of the belt is taken to be constant.
/// \param points  of one slip: the stick before it, the slip, and what follows it, or up to its trough alone.
/// \param captured  the model sticks again after the slip; false: its oscillation goes on.
/// \param start   first guess of onset, S and K.
/// \param shared  first guess of ω, γ and r.
/// \param knowledge  prior of ω, γ and r, after its start().
/// \param sigma   noise of one scan, > 0.
/// \return converged = false with fewer than four points, if the first guess is not admissible (as in
/// fit_slips()), if the fit does not settle in 12 iterations, or if points and prior do not determine it.
[[nodiscard]] CycleFit fit_cycle(std::span<const CyclePoint> points, bool captured,
                                 const model::SlipParameters& start, const model::SharedParameters& shared,
                                 const SharedPosterior& knowledge, double sigma) noexcept;

}  // namespace stickslip::estimate
