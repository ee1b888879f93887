/// \file
/// Fit of a free oscillation to the scans so far: linear least squares with Huber's weights.
#pragma once

#include <cmath>
#include <span>

#include <Eigen/Core>

#include "core/detect/scan_window.hpp"

namespace stickslip::detect {

/// Huber's limit for the choice between two trajectories, in standard deviations; for estimates it is
/// estimate::kHuberLimit. The wrong trajectory has residuals of several standard deviations, which that
/// smaller limit would hide (docs/detector-limits.md).
inline constexpr double kChoiceLimit = 3.0;

/// Change of the cost, in units of log-likelihood, below which fit_free() and fit_captured() have
/// converged.
inline constexpr double kCostConverged = 1e-2;

/// Normal equations of rows about a free oscillation, in scalars, which is faster for three parameters.
class FreeEquations {
 public:
  /// Adds a row.
  /// \param p  the same for all rows.
  /// \param weighted  with Huber's weights; otherwise all weights are 1. The cost is Huber's in either case.
  void add(const ScanRow& row, const FreeOscillation& p, bool weighted = true) noexcept {
    const double z = row.free_residual(p);
    cost += estimate::huber_cost(z, kChoiceLimit);
    double weight = row.scale;
    if (weighted && std::abs(z) > kChoiceLimit) {
      weight *= estimate::huber_weight(z, kChoiceLimit);
      all_within = false;
    }
    const double off = weight * z;
    weight *= row.scale;
    const double weighted_D = weight * row.by_D;
    const double weighted_rate = weight * row.by_rate;
    n00_ += weight;
    n01_ += weighted_D;
    n02_ += weighted_rate;
    n11_ += weighted_D * row.by_D;
    n12_ += weighted_rate * row.by_D;
    n22_ += weighted_rate * row.by_rate;
    g0_ += off;
    g1_ += off * row.by_D;
    g2_ += off * row.by_rate;
  }
  [[nodiscard]] Eigen::Matrix3d normal() const noexcept {
    Eigen::Matrix3d matrix;
    matrix << n00_, n01_, n02_, n01_, n11_, n12_, n02_, n12_, n22_;
    return matrix;
  }
  /// Negative gradient of the cost; without weights, of half the sum of squares.
  [[nodiscard]] Eigen::Vector3d gradient() const noexcept { return {g0_, g1_, g2_}; }

  double cost = 0.0;
  bool all_within = true;  ///< All weights were 1: no residual of a weighted row exceeded Huber's limit.

 private:
  double n00_ = 0.0;
  double n01_ = 0.0;
  double n02_ = 0.0;
  double n11_ = 0.0;
  double n12_ = 0.0;
  double n22_ = 0.0;
  double g0_ = 0.0;
  double g1_ = 0.0;
  double g2_ = 0.0;
};

/// Fits a free oscillation with Huber's weights (kChoiceLimit), in at most three steps, the first unweighted.
/// \param rows  at least three that are no strays.
/// \param p  first guess; becomes the parameters of nearly the least cost.
/// \return Huber's cost at p.
double fit_free(std::span<const ScanRow> rows, FreeOscillation& p) noexcept;

}  // namespace stickslip::detect
