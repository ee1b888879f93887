#include "core/estimate/uniform_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/minimise.hpp"

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;

constexpr int kMostUniformIterations = 60;
/// Decrease of the cost relative to it below which the fit has converged.
constexpr double kUniformConverged = 1e-10;
/// Change of the cost below which it has converged whatever its size: a parameter moves by 4e-5 of its
/// standard error. An exact trace has a cost of rounding errors, which no step lowers.
constexpr double kUniformSettled = 1e-9;

/// In units of σ.
struct UniformEquations {
  P::Matrix normal = P::Matrix::Zero();
  P::Vector gradient = P::Vector::Zero();
  P::Matrix prior = P::Matrix::Zero();
  HuberSums sums;
  double cost = std::numeric_limits<double>::infinity();
};

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

/// Scans of a pull. For minimise().
struct UniformProblem {
  using State = P;
  using Equations = UniformEquations;

  const Trace& trace;
  std::size_t first;
  std::size_t end;
  double sigma;
  const SharedPrior& prior;

  void assemble(const P& parameters, UniformEquations& equations) const {
    equations = {};
    const auto course = model::UniformCourse::make(parameters);
    if (!course) return;
    model::TurnedBasis basis = course->turned_basis();
    for (std::size_t k = first; k < end; ++k) {
      if (trace.usable[k] == 0) continue;
      const model::UniformPoint point = course->at(trace.time_s[k], basis);
      const double z = (trace.level(k) - point.value) / sigma;
      const double weight = equations.sums.add(z);
      const P::Vector by = point.by / sigma;
      equations.normal.noalias() += (weight * by) * by.transpose();
      equations.gradient += weight * z * by;
    }
    const PriorTerms known = prior.at(parameters.shared);
    equations.prior.bottomRightCorner<3, 3>() = known.information;
    equations.gradient.tail<3>() += known.gradient;
    equations.cost = equations.sums.cost() + known.cost;
  }

  [[nodiscard]] double step(const P& from, const UniformEquations& equations, double damping, P& to) const {
    // Only what the scans say is damped: a step along what the prior holds fixed must stay easy.
    P::Matrix damped = equations.normal + equations.prior;
    damped.diagonal() += damping * equations.normal.diagonal();
    const P::Vector step = solve(damped, equations.gradient);
    to = P::from(from.vector() + step);
    return 0.5 * step.dot(equations.gradient);
  }
};

}  // namespace

UniformFit fit_uniform(const Trace& trace, std::size_t first, std::size_t end, const P& guess, double sigma,
                       const SharedPrior& prior) {
  UniformFit fit;
  fit.parameters = guess;
  const UniformProblem problem{trace, first, end, sigma, prior};
  UniformEquations equations;
  problem.assemble(guess, equations);
  fit.converged = minimise(
      problem, fit.parameters, equations,
      {.iterations = kMostUniformIterations, .absolute = kUniformSettled, .relative = kUniformConverged});
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
