#include "core/friction/slip_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace stickslip::friction {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Huber's limit in standard deviations.
constexpr double kHuber = 1.345;
constexpr int kMostIterations = 60;
/// Relative change of the cost below which the fit has converged.
constexpr double kConverged = 1e-10;
/// Damping: first value, factors after success and failure, and where there is no hope left.
constexpr double kFirstDamping = 1e-3;
constexpr double kSmallestDamping = 1e-12;
constexpr double kEasier = 0.2;
constexpr double kHarder = 5.0;
constexpr double kHopeless = 1e8;

/// Normal equations of one slip.
struct SlipBlock {
  Matrix3d own = Matrix3d::Zero();
  Matrix3d mixed = Matrix3d::Zero();  ///< own × shared
  Vector3d gradient = Vector3d::Zero();
};

struct NormalEquations {
  std::vector<SlipBlock> slips;
  Matrix3d shared = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  double cost = 0.0;        ///< Huber's, in units of σ².
  double square_sum = 0.0;  ///< Of the weighted residuals.
  double weight_sum = 0.0;
  double psi_square_sum = 0.0;  ///< Of the residuals cut at Huber's limit.
  double inlier_count = 0.0;    ///< Scans within Huber's limit.
  double count = 0.0;           ///< Usable scans.
};

double huber_cost(double z) noexcept {
  const double size = std::abs(z);
  return size <= kHuber ? 0.5 * z * z : kHuber * (size - 0.5 * kHuber);
}

NormalEquations assemble(const Trace& trace, const std::vector<SlipWindow>& windows,
                         const SharedParameters& shared, double sigma) {
  NormalEquations equations;
  equations.slips.resize(windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const SlipModel model{shared, windows[i].slip, windows[i].captured};
    SlipBlock& block = equations.slips[i];
    for (std::size_t k = windows[i].first; k < windows[i].end; ++k) {
      if (trace.usable[k] == 0) continue;
      const SlipModelPoint point = model.at(trace.time_s[k]);
      const double residual = trace.value[k] - point.value;
      const double z = residual / sigma;
      const double weight = std::abs(z) <= kHuber ? 1.0 : kHuber / std::abs(z);
      equations.cost += huber_cost(z);
      equations.square_sum += weight * residual * residual;
      equations.weight_sum += weight;
      equations.psi_square_sum += weight * weight * residual * residual;
      equations.count += 1.0;
      if (weight == 1.0) equations.inlier_count += 1.0;
      block.own += weight * point.by_slip * point.by_slip.transpose();
      block.mixed += weight * point.by_slip * point.by_shared.transpose();
      block.gradient += weight * residual * point.by_slip;
      equations.shared += weight * point.by_shared * point.by_shared.transpose();
      equations.gradient += weight * residual * point.by_shared;
    }
  }
  return equations;
}

double cost_of(const Trace& trace, const std::vector<SlipWindow>& windows, const SharedParameters& shared,
               double sigma) {
  double cost = 0.0;
  for (const SlipWindow& window : windows) {
    const SlipModel model{shared, window.slip, window.captured};
    for (std::size_t k = window.first; k < window.end; ++k) {
      if (trace.usable[k] != 0)
        cost += huber_cost((trace.value[k] - model.at(trace.time_s[k]).value) / sigma);
    }
  }
  return cost;
}

Matrix3d damped(const Matrix3d& matrix, double damping) {
  Matrix3d result = matrix;
  result.diagonal() *= 1.0 + damping;
  return result;
}

/// Physical region of the shared parameters: an oscillation that decays slower than it swings.
bool admissible(const SharedParameters& shared) {
  return std::isfinite(shared.omega) && shared.omega > 0.0 && shared.r > 0.0 &&
         std::abs(shared.gamma) < 2.0 * shared.omega;
}

struct Step {
  Vector3d shared;
  std::vector<Vector3d> slips;
  bool solved = false;
};

Step solve(const NormalEquations& equations, double damping) {
  Step step;
  Matrix3d reduced = damped(equations.shared, damping);
  Vector3d right = equations.gradient;
  std::vector<Matrix3d> inverses;
  inverses.reserve(equations.slips.size());
  for (const SlipBlock& block : equations.slips) {
    inverses.emplace_back(damped(block.own, damping).inverse());
    reduced -= block.mixed.transpose() * inverses.back() * block.mixed;
    right -= block.mixed.transpose() * inverses.back() * block.gradient;
  }
  step.shared = reduced.ldlt().solve(right);
  step.solved = step.shared.allFinite();
  for (std::size_t i = 0; i < equations.slips.size() && step.solved; ++i) {
    const SlipBlock& block = equations.slips[i];
    step.slips.emplace_back(inverses[i] * (block.gradient - block.mixed * step.shared));
    step.solved = step.slips.back().allFinite();
  }
  return step;
}

/// Covariances at the optimum, in terms of the residuals found.
void finish(SlipFit& fit, std::vector<SlipWindow>& windows, const NormalEquations& equations) {
  const double parameters = 3.0 + 3.0 * static_cast<double>(windows.size());
  for (const SlipWindow& window : windows) fit.scan_count += window.end - window.first;
  const double freedom = equations.weight_sum - parameters;
  fit.residual_sigma = freedom > 0.0 ? std::sqrt(equations.square_sum / freedom) : 0.0;
  // Variance of an M-estimator: Σψ²/(n − p)/(mean ψ′)² · (JᵀJ)⁻¹ [Huber, Robust Statistics, 1981, (6.5)];
  // the equations hold Σ w J Jᵀ, which is smaller by the mean weight. Weighted least squares instead
  // would leave out that Huber's weights follow the noise: 15 % too small a variance for Gaussian noise.
  const double count = std::max(equations.count, 1.0);
  const double inlier_part = std::max(equations.inlier_count, 1.0) / count;
  const double mean_weight = equations.weight_sum / count;
  const double psi_freedom = count - parameters;
  const double variance =
      psi_freedom > 0.0 ? equations.psi_square_sum / psi_freedom * mean_weight / (inlier_part * inlier_part)
                        : 0.0;
  Matrix3d reduced = equations.shared;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const SlipBlock& block = equations.slips[i];
    const Matrix3d inverse = block.own.inverse();
    windows[i].inverse_curvature = variance * inverse;
    windows[i].coupling = inverse * block.mixed;
    reduced -= block.mixed.transpose() * windows[i].coupling;
  }
  fit.shared_covariance = variance * reduced.inverse();
  fit.converged = fit.converged && freedom > 0.0 && fit.shared_covariance.allFinite() &&
                  fit.shared_covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

SlipFit fit_slips(const Trace& trace, std::vector<SlipWindow>& windows, const SharedParameters& shared,
                  double sigma) {
  SlipFit fit;
  fit.shared = shared;
  if (windows.empty() || !admissible(shared)) return fit;
  NormalEquations equations = assemble(trace, windows, fit.shared, sigma);
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < kMostIterations && !fit.converged && damping < kHopeless; ++iteration) {
    const Step step = solve(equations, damping);
    SharedParameters trial = fit.shared;
    // Windows are large and many: they are tried in place.
    std::vector<SlipParameters> before;
    before.reserve(windows.size());
    for (const SlipWindow& window : windows) before.push_back(window.slip);
    double trial_cost = std::numeric_limits<double>::infinity();
    if (step.solved) {
      trial.omega += step.shared[0];
      trial.gamma += step.shared[1];
      trial.r += step.shared[2];
      for (std::size_t i = 0; i < windows.size(); ++i) {
        windows[i].slip.onset_s += step.slips[i][0];
        windows[i].slip.S += step.slips[i][1];
        windows[i].slip.K += step.slips[i][2];
      }
      if (admissible(trial)) trial_cost = cost_of(trace, windows, trial, sigma);
    }
    if (trial_cost <= equations.cost) {
      fit.converged = equations.cost - trial_cost <= kConverged * equations.cost;
      fit.shared = trial;
      equations = {};  // Not both at once.
      equations = assemble(trace, windows, fit.shared, sigma);
      damping = std::max(damping * kEasier, kSmallestDamping);
    } else {
      for (std::size_t i = 0; i < windows.size(); ++i) windows[i].slip = before[i];
      damping *= kHarder;
    }
  }
  finish(fit, windows, equations);
  return fit;
}

Eigen::Matrix3d SlipFit::mean_covariance(const std::vector<SlipWindow>& windows) const {
  Matrix3d own = Matrix3d::Zero();
  Matrix3d coupling = Matrix3d::Zero();
  for (const SlipWindow& window : windows) {
    own += window.inverse_curvature;
    coupling += window.coupling;
  }
  const auto count = static_cast<double>(windows.size());
  coupling /= count;
  return own / (count * count) + coupling * shared_covariance * coupling.transpose();
}

Eigen::Matrix3d SlipFit::covariance(const SlipWindow& window) const {
  return window.inverse_curvature + window.coupling * shared_covariance * window.coupling.transpose();
}

}  // namespace stickslip::friction
