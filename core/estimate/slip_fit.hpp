/// \file
/// Maximum-likelihood fit of the closed-form model to all slips of a test at once: ω, γ and the
/// stick rate r are shared, onset, S and K belong to each slip.
///
///     std::vector<SlipWindow> windows = …;            // with a first guess
///     SharedParameters shared = …;
///     const SlipFit fit = fit_slips(trace, windows, shared, sigma);
///
/// The normal equations' 3 × 3 block of each slip is eliminated first (Schur complement), so that the time
/// of an iteration is proportional to the number of scans. Robust by Huber's weights with k = 1.345, which
/// keep 95 % efficiency for Gaussian noise [Huber, Ann. Math. Stat. 35:73–101, 1964].
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Scans [first, end) of the trace that belong to one slip from sticking and to the swings that follow it
/// without a stick; with the slip's parameters.
struct SlipWindow {
  std::size_t first = 0;
  std::size_t end = 0;
  bool captured = false;       ///< The model sticks again after the slip; false: its oscillation goes on.
  model::SlipParameters slip;  ///< First guess; the estimate after the fit. S and K without Trace::drift.

  // Set by fit_slips() for covariances.
  /// Covariance of (onset, S, K) if ω, γ and r were known.
  Eigen::Matrix3d inverse_curvature = Eigen::Matrix3d::Zero();
  /// −∂(onset, S, K)/∂(ω, γ, r) at the optimum.
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
};

/// Result of fit_slips(): shared parameters, covariances and cost.
struct SlipFit {
  bool converged = false;
  model::SharedParameters shared;
  Eigen::Matrix3d shared_covariance = Eigen::Matrix3d::Zero();  ///< Of (ω, γ, r).
  double residual_sigma = 0.0;  ///< Scans about the model: σ times HuberSums::residual_sigma().
  std::size_t scan_count = 0;   ///< Of all windows, unusable scans included.
  double cost = 0.0;            ///< Huber's, of scans and prior.
  double cost_scale = 0.0;      ///< HuberSums::cost_scale().
  double freedom = 0.0;         ///< Degrees of freedom: usable scans less parameters.

  // The windows are those that fit_slips() filled.
  /// Covariance of the mean of (onset, S, K) over `windows`, not empty, from noise alone: without the scatter
  /// from slip to slip.
  [[nodiscard]] Eigen::Matrix3d mean_covariance(const std::vector<SlipWindow>& windows) const;
  /// Covariance of one slip's (onset, S, K), including the uncertainty of ω, γ and r, and scaled by
  /// HuberSums::covariance_scale(). No estimate unless the fit converged.
  [[nodiscard]] Eigen::Matrix3d covariance(const SlipWindow& window) const;
  /// Standard error of the slip's onset, s.
  [[nodiscard]] double onset_error_s(const SlipWindow& window) const;
  /// Standard error of the slip's S − K.
  [[nodiscard]] double delta_mu_error(const SlipWindow& window) const;
};

/// Change of the cost, in units of log-likelihood, below which a fit of a test has settled: all parameters
/// together then move by 4.5e-3 of a standard error. An exact trace has a cost of rounding errors, which no
/// step lowers.
inline constexpr double kFitSettled = 1e-5;

/// Fits all slips at once. `windows` and SlipFit::shared become the estimate. If the fit does not converge
/// they are where it stopped; if it cannot begin, the first guess, and SlipFit::scan_count is 0.
/// \param sigma  noise of one scan, > 0; scales Huber's limit.
/// \param windows,shared  first guess. Each window needs at least four usable scans.
/// \param prior  of the shared parameters.
/// \param settled  The fit has converged when a step changes the cost by at most this plus 1e-10 of it.
/// \return converged = false without windows; if the first guess is not admissible: ω > 0, r > 0, |γ| < 2ω,
/// S − K ≥ −6σ; if the fit does not settle in 60 iterations, 200 with a prior; or if scans and prior do not
/// determine the parameters.
[[nodiscard]] SlipFit fit_slips(const Trace& trace, std::vector<SlipWindow>& windows,
                                const model::SharedParameters& shared, double sigma,
                                const SharedPrior& prior = {}, double settled = kFitSettled);

}  // namespace stickslip::estimate
