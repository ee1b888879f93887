#include "core/estimate/uniform_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/minimise.hpp"
#include "core/estimate/slip_fit.hpp"
#include "core/estimate/slip_sums.hpp"

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;

constexpr int kMostUniformIterations = 60;
/// Decrease of the cost relative to it below which the fit has converged.
constexpr double kUniformConverged = 1e-10;
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

  std::vector<TraceScan> scans;
  double sigma;
  const SharedPrior& prior;

  void assemble(const P& parameters, UniformEquations& equations) const {
    equations = {};
    const auto course = model::UniformTrajectory::make(parameters);
    if (!course) return;
    model::TurnedBasis basis{parameters.shared.oscillator()};
    const double per_sigma = 1.0 / sigma;
    for (auto scan = scans.begin(); scan != scans.end();) {
      const model::UniformTrajectory::Cycle cycle = course->cycle_at(scan->time_s);
      SlipSums sums;
      for (; scan != scans.end() && scan->time_s < cycle.end_s; ++scan) {
        const model::SlipPlace at = course->slip().place(scan->time_s - cycle.after_first_s, basis);
        const double z = (scan->level - at.value) * per_sigma;
        sums.add(at, equations.sums.add(z), z);
      }
      // The derivatives of a cycle: those of the first, by, and by[onset] times those of its delay.
      const P::Matrix own = sums.normal(course->slip());
      const P::Vector gradient = sums.gradient(course->slip());
      const P::Vector by_delay = cycle.number * course->period_slope();
      const P::Matrix delayed = by_delay * own.row(P::kOnset);
      equations.normal += own + delayed + delayed.transpose();
      equations.normal.noalias() += (own(P::kOnset, P::kOnset) * by_delay) * by_delay.transpose();
      equations.gradient += gradient + gradient[P::kOnset] * by_delay;
    }
    equations.normal *= per_sigma * per_sigma;
    equations.gradient *= per_sigma;
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
  UniformProblem problem{{}, sigma, prior};
  append_usable(trace, first, end, problem.scans);
  UniformEquations equations;
  problem.assemble(guess, equations);
  fit.converged = minimise(
      problem, fit.parameters, equations,
      {.iterations = kMostUniformIterations, .absolute = kFitSettled, .relative = kUniformConverged});
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
