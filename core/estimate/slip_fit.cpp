#include "core/estimate/slip_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/levenberg_marquardt.hpp"

namespace stickslip::estimate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Limit of the iterations; a dozen nearly always suffices.
constexpr int kMostFitIterations = 60;
/// Limit of the iterations with a prior. A pull speed known to 1e-6 gives the cost a narrow, curved valley,
/// along which some fits need a hundred iterations.
constexpr int kMostFitIterationsWithPrior = 200;
/// Relative change of the cost below which the fit has converged.
constexpr double kFitConverged = 1e-10;
/// Factors of the damping after a step that lowers the cost and one that does not.
constexpr double kFitEasier = 0.2;
constexpr double kFitHarder = 5.0;

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
  HuberSums sums;     ///< Of the residuals over σ.
  double cost = 0.0;  ///< Of scans and prior.
  PriorTerms prior;
};

NormalEquations assemble(const Trace& trace, const std::vector<SlipWindow>& windows,
                         const model::SharedParameters& shared, double sigma, const SharedPrior& prior) {
  NormalEquations equations;
  equations.slips.resize(windows.size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const model::SlipModel model{shared, windows[i].slip, windows[i].captured, trace.belt};
    SlipBlock& block = equations.slips[i];
    for (std::size_t k = windows[i].first; k < windows[i].end; ++k) {
      if (trace.usable[k] == 0) continue;
      const model::SlipModelPoint point = model.at(trace.time_s[k]);
      const double residual = trace.level(k) - point.value;
      const double weight = equations.sums.add(residual / sigma);
      block.own += weight * point.by_slip * point.by_slip.transpose();
      block.mixed += weight * point.by_slip * point.by_shared.transpose();
      block.gradient += weight * residual * point.by_slip;
      equations.shared += weight * point.by_shared * point.by_shared.transpose();
      equations.gradient += weight * residual * point.by_shared;
    }
  }
  equations.prior = prior.at(shared);
  // The equations of the scans are in units of σ².
  equations.gradient += sigma * sigma * equations.prior.gradient;
  equations.cost = equations.sums.cost() + equations.prior.cost;
  return equations;
}

Matrix3d damped(const Matrix3d& matrix, double damping) {
  Matrix3d result = matrix;
  result.diagonal() *= 1.0 + damping;
  return result;
}

/// Whether the shared parameters are physical: ω > 0, r > 0 and |γ| < 2ω.
bool admissible(const model::SharedParameters& shared) {
  return std::isfinite(shared.omega) && shared.omega > 0.0 && shared.r > 0.0 &&
         std::abs(shared.gamma) < 2.0 * shared.omega;
}

/// Whether each S − K is at least −6σ, as noise allows. The cost has a second minimum with S far below K,
/// which a step could reach: there the free oscillation meets the line of the stick half a period before the
/// onset.
bool admissible(const std::vector<SlipWindow>& windows, double sigma) {
  constexpr double kLowestFitSigmas = 6.0;  // Half of detect::SlipRule::kSignificantSigmas.
  return std::all_of(windows.begin(), windows.end(), [&](const SlipWindow& window) {
    return window.slip.S - window.slip.K >= -kLowestFitSigmas * sigma;
  });
}

struct Step {
  Vector3d shared;
  std::vector<Vector3d> slips;
  bool solved = false;
};

Step solve(const NormalEquations& equations, double sigma, double damping) {
  Step step;
  // Only what the scans say is damped: a step along what the prior holds fixed must stay easy.
  Matrix3d reduced = damped(equations.shared, damping) + sigma * sigma * equations.prior.information;
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
void finish(SlipFit& fit, std::vector<SlipWindow>& windows, const NormalEquations& equations, double sigma) {
  const double parameters = 3.0 + 3.0 * static_cast<double>(windows.size());
  for (const SlipWindow& window : windows) fit.scan_count += window.end - window.first;
  fit.residual_sigma = sigma * equations.sums.residual_sigma(parameters);
  fit.cost = equations.cost;
  fit.cost_scale = equations.sums.cost_scale(parameters);
  fit.freedom = equations.sums.count() - parameters;
  const double variance = sigma * sigma * equations.sums.covariance_scale(parameters);
  Matrix3d reduced = equations.shared;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const SlipBlock& block = equations.slips[i];
    const Matrix3d inverse = block.own.inverse();
    windows[i].inverse_curvature = variance * inverse;
    windows[i].coupling = inverse * block.mixed;
    reduced -= block.mixed.transpose() * windows[i].coupling;
  }
  // The estimate answers to the noise of both, scans and prior, through the one inverse.
  const Matrix3d prior = sigma * sigma * equations.prior.information;
  const Matrix3d response = (reduced + prior).inverse();
  fit.shared_covariance =
      variance * response * reduced * response + sigma * sigma * response * prior * response;
  fit.converged = fit.converged && equations.sums.freedom(parameters) > 0.0 &&
                  fit.shared_covariance.allFinite() && fit.shared_covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

SlipFit fit_slips(const Trace& trace, std::vector<SlipWindow>& windows, const model::SharedParameters& shared,
                  double sigma, const SharedPrior& prior) {
  SlipFit fit;
  fit.shared = shared;
  if (windows.empty() || !admissible(shared)) return fit;
  NormalEquations equations = assemble(trace, windows, fit.shared, sigma, prior);
  double damping = kFirstDamping;
  const int most = prior.empty() ? kMostFitIterations : kMostFitIterationsWithPrior;
  for (int iteration = 0; iteration < most && !fit.converged && damping < kHopeless; ++iteration) {
    const Step step = solve(equations, sigma, damping);
    model::SharedParameters trial = fit.shared;
    std::vector<model::SlipParameters> before;
    before.reserve(windows.size());
    for (const SlipWindow& window : windows) before.push_back(window.slip);
    NormalEquations there;
    there.cost = std::numeric_limits<double>::infinity();
    if (step.solved) {
      trial.omega += step.shared[0];
      trial.gamma += step.shared[1];
      trial.r += step.shared[2];
      for (std::size_t i = 0; i < windows.size(); ++i) {
        windows[i].slip.onset_s += step.slips[i][0];
        windows[i].slip.S += step.slips[i][1];
        windows[i].slip.K += step.slips[i][2];
      }
      if (admissible(trial) && admissible(windows, sigma)) {
        there = assemble(trace, windows, trial, sigma, prior);
      }
    }
    if (there.cost <= equations.cost) {
      fit.converged = equations.cost - there.cost <= kFitConverged * equations.cost;
      fit.shared = trial;
      equations = std::move(there);
      damping = std::max(damping * kFitEasier, kSmallestDamping);
    } else {
      // At the optimum the cost cannot fall, and rounding decides its sign.
      fit.converged = there.cost - equations.cost <= kFitConverged * equations.cost;
      for (std::size_t i = 0; i < windows.size(); ++i) windows[i].slip = before[i];
      damping *= kFitHarder;
    }
  }
  finish(fit, windows, equations, sigma);
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

double SlipFit::onset_error_s(const SlipWindow& window) const { return std::sqrt(covariance(window)(0, 0)); }

double SlipFit::delta_mu_error(const SlipWindow& window) const {
  const Eigen::Matrix3d own = covariance(window);
  return std::sqrt(own(1, 1) + own(2, 2) - 2.0 * own(1, 2));
}

}  // namespace stickslip::estimate
