#include "core/estimate/cycle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/minimise.hpp"
#include "core/estimate/slip_sums.hpp"

namespace stickslip::estimate {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = model::SlipModelPoint::Derivatives;

/// Limit of the iterations, over up to 256 points each. It bounds the processing time of the scan that closes
/// a cycle.
constexpr int kMostCycleIterations = 12;
/// Change of the cost, in units of log-likelihood, below which the fit has converged: a parameter then moves
/// by √(2 · this) of its standard error.
constexpr double kCycleConverged = 1e-5;
/// Lowest S − K in σ that a step may reach, as in fit_slips(): noise may bring S slightly below K.
constexpr double kLowestSigmas = 6.0;
constexpr std::size_t kFewestCyclePoints = 4;
/// Variance of Huber's estimate over that of least squares, for Gaussian noise: 95 % efficiency [Huber 1964].
constexpr double kHuberVariance = 1.0 / 0.95;
/// Residuals are larger than noise if their standard deviation exceeds 1 by this many of its standard errors,
/// 1/√(2n) for n scans.
constexpr double kCycleMisfitSigmas = 3.0;

struct CycleEquations {
  Matrix6d scans = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();  ///< Of scans alone, down the cost.
  PriorTerms known;
  HuberSums sums;
  double cost = 0.0;
  double capture_s = 0.0;  ///< After the onset; infinity if not captured.
};

struct CycleState {
  model::SlipParameters slip;
  model::SharedParameters shared;
};

/// Unit of each parameter: onsets are milliseconds, ω hundreds.
Vector6d units_of(const Matrix6d& normal) noexcept {
  return normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
}

/// Scans of one slip and what is known of the tester. For minimise().
struct CycleProblem {
  using State = CycleState;
  using Equations = CycleEquations;

  std::span<const CyclePoint> points;
  bool captured;
  const SharedPosterior& knowledge;
  double sigma;

  [[nodiscard]] bool admissible(const State& at) const noexcept {
    const auto& [slip, shared] = at;
    return std::isfinite(slip.onset_s) && std::isfinite(slip.S) && std::isfinite(slip.K) &&
           shared.omega > 0.0 && shared.r > 0.0 && std::abs(shared.gamma) < 2.0 * shared.omega &&
           std::isfinite(shared.omega) && std::isfinite(shared.r) &&
           slip.S - slip.K >= -kLowestSigmas * sigma;
  }

  void assemble(const State& at, Equations& equations) const noexcept {
    equations = {};
    equations.cost = std::numeric_limits<double>::infinity();
    if (!admissible(at)) return;
    const model::SlipModel model{at.shared, at.slip, captured};
    model::TurnedBasis basis{model.waveform().oscillator};
    SlipSums sums;
    const double per_sigma = 1.0 / sigma;
    for (const CyclePoint& point : points) {
      // The mean over a point's scans: the value at their mean time, and half the curvature times the
      // variance of their times. The derivatives' own curvature affects only the steps.
      const model::SlipPlace place = model.place(point.time_s, basis);
      const double value = place.value + 0.5 * point.spread_s2 * model.curvature(place);
      const double scale = (point.count == 1.0 ? 1.0 : std::sqrt(point.count)) * per_sigma;
      const double residual = point.value - value;
      sums.add(place, equations.sums.add(residual * scale) * scale * scale, residual);
    }
    equations.scans = sums.normal(model);
    equations.gradient = sums.gradient(model);
    equations.known = knowledge.at(at.shared);
    equations.cost = equations.sums.cost() + equations.known.cost;
    equations.capture_s = model.capture_s();
  }

  [[nodiscard]] double step(const State& from, const Equations& equations, double damping,
                            State& to) const noexcept {
    Matrix6d normal = equations.scans;
    normal.diagonal() *= 1.0 + damping;
    normal.bottomRightCorner<3, 3>() += equations.known.information;
    Vector6d down = equations.gradient;
    down.tail<3>() += equations.known.gradient;
    const Vector6d unit = units_of(normal);
    const Matrix6d scaled = unit.asDiagonal() * normal * unit.asDiagonal();
    const Vector6d step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(down)));
    to.slip = {from.slip.onset_s + step[0], from.slip.S + step[1], from.slip.K + step[2]};
    to.shared = {from.shared.omega + step[3], from.shared.gamma + step[4], from.shared.r + step[5]};
    return 0.5 * step.dot(down);
  }
};

/// What the scans alone say about (ω, γ, r): their equations without the slip's own parameters.
SharedEvidence evidence_of(const CycleEquations& equations, const model::SharedParameters& shared) noexcept {
  const Eigen::Matrix3d own = equations.scans.topLeftCorner<3, 3>();
  const Eigen::Matrix3d mixed = equations.scans.topRightCorner<3, 3>();
  const Eigen::Matrix3d inverse = own.inverse();
  SharedEvidence evidence;
  evidence.information = equations.scans.bottomRightCorner<3, 3>() - mixed.transpose() * inverse * mixed;
  evidence.weighted = evidence.information * Eigen::Vector3d{shared.omega, shared.gamma, shared.r} +
                      equations.gradient.tail<3>() -
                      mixed.transpose() * inverse * equations.gradient.head<3>();
  return evidence;
}

void finish(CycleFit& fit, const CycleEquations& equations) noexcept {
  constexpr double kOwnParameters = 3.0;
  Matrix6d normal = equations.scans;
  normal.bottomRightCorner<3, 3>() += equations.known.information;
  const Vector6d scale = units_of(normal);
  const Matrix6d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Matrix6d inverse = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  fit.residual_sigmas = equations.sums.residual_sigma(kOwnParameters);
  // Where the model leaves more than noise, that is what it is uncertain by. Few scans do not tell their
  // noise better than σ is known.
  const double expected = 1.0 + kCycleMisfitSigmas / std::sqrt(2.0 * std::max(equations.sums.count(), 1.0));
  const double variance = fit.residual_sigmas > expected
                              ? std::max(equations.sums.covariance_scale(kOwnParameters), kHuberVariance)
                              : kHuberVariance;
  fit.covariance = variance * inverse.topLeftCorner<3, 3>();
  fit.evidence = evidence_of(equations, fit.shared);
  fit.evidence.information /= variance;
  fit.evidence.weighted /= variance;
  fit.capture_s = equations.capture_s;
  fit.converged = fit.converged && fit.covariance.allFinite() && fit.covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

CycleFit fit_cycle(std::span<const CyclePoint> points, bool captured, const model::SlipParameters& start,
                   const model::SharedParameters& shared, const SharedPosterior& knowledge,
                   double sigma) noexcept {
  CycleFit fit;
  const CycleProblem problem{points, captured, knowledge, sigma};
  CycleState state{start, shared};
  fit.slip = start;
  fit.shared = state.shared;
  if (points.size() < kFewestCyclePoints) return fit;
  CycleEquations equations;
  problem.assemble(state, equations);
  if (!std::isfinite(equations.cost)) return fit;
  fit.converged =
      minimise(problem, state, equations, {.iterations = kMostCycleIterations, .absolute = kCycleConverged});
  fit.slip = state.slip;
  fit.shared = state.shared;
  finish(fit, equations);
  return fit;
}

}  // namespace stickslip::estimate
