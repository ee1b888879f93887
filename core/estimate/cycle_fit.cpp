#include "core/estimate/cycle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/levenberg_marquardt.hpp"
#include "core/model/capture.hpp"

namespace stickslip::estimate {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = CycleCourse::Row;

/// Limit of the iterations, over up to 256 points each. It bounds the processing time of the scan that closes
/// a cycle.
constexpr int kMostCycleIterations = 12;
/// Change of the cost, in units of log-likelihood, below which the fit has converged: a parameter then moves
/// by √(2 · this) of its standard error.
constexpr double kCycleConverged = 1e-5;
/// Factors of the damping after a step that lowers the cost and one that does not.
constexpr double kCycleEasier = 0.1;
constexpr double kCycleHarder = 10.0;
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
};

CycleEquations assemble(std::span<const CyclePoint> points, bool captured, const model::SlipParameters& slip,
                        const model::SharedParameters& shared, const SharedKnowledge& knowledge,
                        double sigma) noexcept {
  CycleEquations equations;
  const CycleCourse course{shared, slip, captured};
  for (const CyclePoint& point : points) {
    const CycleCourse::Point at = course.mean_over(point);
    const double scale = std::sqrt(point.count) / sigma;
    const double z = (point.value - at.value) * scale;
    const double weight = equations.sums.add(z);
    const Vector6d row = at.by * scale;
    equations.scans.noalias() += (weight * row) * row.transpose();
    equations.gradient += weight * z * row;
  }
  equations.known = knowledge.at(shared);
  equations.cost = equations.sums.cost() + equations.known.cost;
  return equations;
}

bool admissible(const model::SlipParameters& slip, const model::SharedParameters& shared,
                double sigma) noexcept {
  return std::isfinite(slip.onset_s) && std::isfinite(slip.S) && std::isfinite(slip.K) &&
         shared.omega > 0.0 && shared.r > 0.0 && std::abs(shared.gamma) < 2.0 * shared.omega &&
         std::isfinite(shared.omega) && std::isfinite(shared.r) && slip.S - slip.K >= -kLowestSigmas * sigma;
}

/// Solves with each parameter in a unit of its own: onsets are milliseconds, ω hundreds.
Vector6d step_of(const CycleEquations& equations, double damping) noexcept {
  Matrix6d normal = equations.scans;
  normal.diagonal() *= 1.0 + damping;
  normal.bottomRightCorner<3, 3>() += equations.known.information;
  Vector6d down = equations.gradient;
  down.tail<3>() += equations.known.gradient;
  const Vector6d scale =
      normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(down)));
}

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
  const Vector6d scale =
      normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
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
  fit.capture_s = std::numeric_limits<double>::infinity();
  fit.converged = fit.converged && fit.covariance.allFinite() && fit.covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

CycleCourse::CycleCourse(const model::SharedParameters& shared, const model::SlipParameters& slip,
                         bool captured) noexcept
    : shared_(shared),
      slip_(slip),
      waveform_{slip.K, slip.S - slip.K, shared.r, shared.oscillator()},
      capture_s_(captured ? model::capture_time_s(waveform_, shared.r).value_or(waveform_.rise_end_time_s())
                          : std::numeric_limits<double>::infinity()) {
  if (captured) at_capture_ = slipping(capture_s_);
}

CycleCourse::Point CycleCourse::slipping(double tau_s) const noexcept {
  // As SlipModel, with what c, c′ and c″ share worked out once.
  const auto& [omega, gamma, r] = shared_;
  const double D = slip_.S - slip_.K;
  const double B = (r + 0.5 * gamma * D) / omega;
  const double decay = std::exp(-0.5 * gamma * tau_s);
  const double cosine = decay * std::cos(omega * tau_s);
  const double sine = decay * std::sin(omega * tau_s);
  const double swing = D * cosine + B * sine;
  const double by_D = cosine + 0.5 * gamma / omega * sine;
  const double rate = r * cosine - (0.5 * gamma * B + omega * D) * sine;
  Point point;
  point.value = slip_.K + swing;
  point.curvature = -gamma * rate - (omega * omega + 0.25 * gamma * gamma) * swing;
  point.by << -rate, by_D, 1.0 - by_D, tau_s * (B * cosine - D * sine) - B / omega * sine,
      -0.5 * tau_s * swing + 0.5 * D / omega * sine, sine / omega;
  return point;
}

CycleCourse::Point CycleCourse::at(double time_s) const noexcept {
  const double tau_s = time_s - slip_.onset_s;
  if (tau_s < 0.0) {
    Point point;
    point.value = slip_.S + shared_.r * tau_s;
    point.by << -shared_.r, 1.0, 0.0, 0.0, 0.0, tau_s;
    return point;
  }
  if (tau_s <= capture_s_) return slipping(tau_s);
  Point point = at_capture_;
  const double since_s = tau_s - capture_s_;
  point.value += shared_.r * since_s;
  point.curvature = 0.0;
  point.by[0] = -shared_.r;
  point.by[5] += since_s;
  return point;
}

CycleCourse::Point CycleCourse::mean_over(const CyclePoint& point) const noexcept {
  Point mean = at(point.time_s);
  mean.value += 0.5 * point.spread_s2 * mean.curvature;
  return mean;
}

CycleFit fit_cycle(std::span<const CyclePoint> points, bool captured, const model::SlipParameters& start,
                   const SharedKnowledge& knowledge, double sigma) noexcept {
  CycleFit fit;
  fit.slip = start;
  fit.shared = knowledge.best();
  if (points.size() < kFewestCyclePoints || !admissible(start, fit.shared, sigma)) return fit;
  CycleEquations equations = assemble(points, captured, fit.slip, fit.shared, knowledge, sigma);
  double damping = kFirstDamping;
  while (!fit.converged && fit.iterations < kMostCycleIterations) {
    ++fit.iterations;
    const Vector6d step = step_of(equations, damping);
    const model::SlipParameters slip{fit.slip.onset_s + step[0], fit.slip.S + step[1], fit.slip.K + step[2]};
    const model::SharedParameters shared{fit.shared.omega + step[3], fit.shared.gamma + step[4],
                                         fit.shared.r + step[5]};
    if (!step.allFinite() || !admissible(slip, shared, sigma)) {
      damping *= kCycleHarder;
      continue;
    }
    const CycleEquations trial = assemble(points, captured, slip, shared, knowledge, sigma);
    const double fallen = equations.cost - trial.cost;
    // At the optimum the cost cannot fall, and rounding decides its sign.
    fit.converged = std::abs(fallen) <= kCycleConverged;
    if (fallen >= 0.0) {
      fit.slip = slip;
      fit.shared = shared;
      equations = trial;
      damping *= kCycleEasier;
    } else {
      damping *= kCycleHarder;
    }
  }
  finish(fit, equations);
  if (captured) fit.capture_s = CycleCourse{fit.shared, fit.slip, true}.capture_s();
  return fit;
}

}  // namespace stickslip::estimate
