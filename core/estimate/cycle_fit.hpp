/// \file
/// Live maximum-likelihood fit of the closed form to the scans of one slip.
///
///     const CycleFit fit = fit_cycle(buffer.points(), true, first_guess, knowledge, sigma);
///
/// Levenberg–Marquardt on six parameters with analytic derivatives and Huber's weights, as the fit of the
/// whole test (core/estimate/slip_fit); the present knowledge of ω, γ and r (SharedKnowledge) enters as a
/// Gaussian prior. All matrices have fixed sizes; nothing is allocated.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/estimate/cycle_buffer.hpp"
#include "core/estimate/shared_knowledge.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Trajectory of one slip with its curvature and derivatives, evaluated from one exponential, one sine and
/// one cosine.
class CycleCourse {
 public:
  using Row = Eigen::Matrix<double, 6, 1>;  ///< Derivatives by (onset, S, K, ω, γ, r).

  struct Point {
    double value = 0.0;
    double curvature = 0.0;  ///< c″, 1/s²
    Row by = Row::Zero();
  };

  /// As SlipModel: stick before the onset, and after the capture if `captured`.
  CycleCourse(const model::SharedParameters& shared, const model::SlipParameters& slip,
              bool captured) noexcept;

  [[nodiscard]] Point at(double time_s) const noexcept;
  /// Mean of the trajectory over the scans of a point: the value at their mean time plus half the curvature
  /// times the variance of their times. `by` is that at the mean time; its error is as small, and affects
  /// only the steps of the fit.
  [[nodiscard]] Point mean_over(const CyclePoint& point) const noexcept;
  /// Capture time, seconds after the onset; infinity if not captured.
  [[nodiscard]] double capture_s() const noexcept { return capture_s_; }
  [[nodiscard]] const model::SlipWaveform& waveform() const noexcept { return waveform_; }

 private:
  [[nodiscard]] Point slipping(double tau_s) const noexcept;

  model::SharedParameters shared_;
  model::SlipParameters slip_;
  model::SlipWaveform waveform_;
  double capture_s_;
  Point at_capture_;
};

/// Result of fit_cycle().
struct CycleFit {
  bool converged = false;
  model::SlipParameters slip;
  model::SharedParameters shared;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< Of (onset, S, K), including the uncertainty of ω, γ and r.
  SharedEvidence evidence;      ///< Information about ω, γ and r from these scans alone, without the prior.
  double capture_s = 0.0;       ///< After the onset; infinity if not captured.
  double residual_sigmas = 0.0;  ///< Standard deviation of the residuals, in σ.
  int iterations = 0;

  [[nodiscard]] double delta_mu() const noexcept { return slip.S - slip.K; }
  [[nodiscard]] double delta_mu_variance() const noexcept {
    return covariance(1, 1) + covariance(2, 2) - 2.0 * covariance(1, 2);
  }
};

/// \param points  of one slip: from the stick before it to the stick, or the free oscillation, after it.
/// \param start   first guess of onset, S and K; that of ω, γ and r is knowledge.best().
/// \param sigma   noise of one scan, > 0.
/// \return converged = false with fewer than four points, or if the fit does not converge.
[[nodiscard]] CycleFit fit_cycle(std::span<const CyclePoint> points, bool captured,
                                 const model::SlipParameters& start, const SharedKnowledge& knowledge,
                                 double sigma) noexcept;

}  // namespace stickslip::estimate
