#include "core/estimate/uniform_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/levenberg_marquardt.hpp"

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;

constexpr int kMostUniformIterations = 60;
/// Decrease of the cost relative to it below which the fit has converged.
constexpr double kUniformConverged = 1e-10;
/// Factors of the damping after a step that lowers the cost and one that does not.
constexpr double kUniformEasier = 0.1;
constexpr double kUniformHarder = 5.0;

/// In units of σ.
struct UniformEquations {
  P::Matrix normal = P::Matrix::Zero();
  P::Vector gradient = P::Vector::Zero();
  P::Matrix prior = P::Matrix::Zero();
  HuberSums sums;
  double cost = std::numeric_limits<double>::infinity();
};

UniformEquations assemble(const Trace& trace, std::size_t first, std::size_t end, const P& parameters,
                          double sigma, const SharedPrior& prior) {
  UniformEquations equations;
  const auto course = model::UniformCourse::make(parameters);
  if (!course) return equations;
  for (std::size_t k = first; k < end; ++k) {
    if (trace.usable[k] == 0) continue;
    const model::UniformPoint point = course->at(trace.time_s[k]);
    const double z = (trace.level(k) - point.value) / sigma;
    const double weight = equations.sums.add(z);
    const P::Vector by = point.by / sigma;
    equations.normal.selfadjointView<Eigen::Lower>().rankUpdate(by, weight);
    equations.gradient += weight * z * by;
  }
  equations.normal = P::Matrix{equations.normal.selfadjointView<Eigen::Lower>()};
  const PriorTerms known = prior.at(parameters.shared);
  equations.prior.bottomRightCorner<3, 3>() = known.information;
  equations.gradient.tail<3>() += known.gradient;
  equations.cost = equations.sums.cost() + known.cost;
  return equations;
}

/// Times and coefficients differ by orders of magnitude, and a prior may be very certain: rows and columns
/// are scaled to a unit diagonal first.
P::Vector solve(const P::Matrix& matrix, const P::Vector& right) {
  const P::Vector scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const P::Matrix scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * right);
}

P::Matrix inverse(const P::Matrix& matrix) {
  const P::Vector scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const P::Matrix scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  return scale.asDiagonal() * P::Matrix{scaled.fullPivLu().inverse()} * scale.asDiagonal();
}

}  // namespace

UniformFit fit_uniform(const Trace& trace, std::size_t first, std::size_t end, const P& guess, double sigma,
                       const SharedPrior& prior) {
  UniformFit fit;
  fit.parameters = guess;
  UniformEquations equations = assemble(trace, first, end, guess, sigma, prior);
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < kMostUniformIterations && !fit.converged && damping < kHopeless &&
                          std::isfinite(equations.cost);
       ++iteration) {
    // Only what the scans say is damped: a step along what the prior holds fixed must stay easy.
    P::Matrix damped = equations.normal + equations.prior;
    damped.diagonal() += damping * equations.normal.diagonal();
    const P::Vector step = solve(damped, equations.gradient);
    if (!step.allFinite()) break;
    const P trial = P::from(fit.parameters.vector() + step);
    UniformEquations there = assemble(trace, first, end, trial, sigma, prior);
    if (there.cost <= equations.cost) {
      fit.converged = equations.cost - there.cost <= kUniformConverged * equations.cost;
      fit.parameters = trial;
      equations = there;
      damping = std::max(damping * kUniformEasier, kSmallestDamping);
    } else {
      // At the optimum the cost cannot fall, and rounding decides its sign.
      fit.converged = there.cost - equations.cost <= kUniformConverged * equations.cost;
      damping *= kUniformHarder;
    }
  }
  const auto count = static_cast<double>(P::Vector::RowsAtCompileTime);
  fit.cost = equations.cost;
  fit.scan_count = equations.sums.count();
  fit.residual_sigma = sigma * equations.sums.residual_sigma(count);
  // The estimate answers to noise of both, scans and prior, through the one inverse.
  const P::Matrix response = inverse(equations.normal + equations.prior);
  const P::Matrix noise = equations.sums.covariance_scale(count) * equations.normal + equations.prior;
  fit.covariance = response * noise * response;
  fit.converged = fit.converged && equations.sums.freedom(count) > 0.0 && fit.covariance.allFinite() &&
                  fit.covariance.diagonal().minCoeff() >= 0.0;
  return fit;
}

}  // namespace stickslip::estimate
