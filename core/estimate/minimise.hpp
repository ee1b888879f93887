/// \file
/// Levenberg–Marquardt [Levenberg, Q. Appl. Math. 2:164–168, 1944; Marquardt, J. SIAM 11(2):431–441, 1963]:
/// the one minimiser of all fits that are not linear.
///
///     MyProblem::State state = first_guess;
///     MyProblem::Equations equations;
///     problem.assemble(state, equations);
///     const bool converged = minimise(problem, state, equations, {.iterations = 60, .relative = 1e-10});
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace stickslip::estimate {

struct MinimiserLimits {
  int iterations = 0;
  /// Largest change of the cost, up or down, with which the fit has converged: absolute + relative · cost. In
  /// units of log-likelihood: a parameter then moves by √(2 · this) of its standard error.
  double absolute = 0.0;
  double relative = 0.0;
};

/// \tparam Problem has two types and two functions:
///   State      the parameters;
///   Equations  normal equations at a state, with `cost`;
///   void assemble(const State&, Equations&) const: cost = infinity where the state is not admissible;
///   double step(const State& from, const Equations&, double damping, State& to) const: the damped
///     Gauss–Newton step, with the diagonal of what the scans say increased by the factor 1 + damping;
///     returns the decrease of the cost that the linear model predicts, NaN if the equations cannot be
///     solved.
/// \param state,equations  first guess and its equations; become those of the least cost found.
/// \return whether it converged. It does not if the cost of the first guess is not finite, the iterations run
/// out, or every step, however damped, raises the cost by more than the limit or cannot be solved for.
template <typename Problem>
bool minimise(const Problem& problem, typename Problem::State& state, typename Problem::Equations& equations,
              const MinimiserLimits& limits) {
  constexpr double kFirstDamping = 1e-3;      // Nearly a Gauss–Newton step.
  constexpr double kSmallestDamping = 1e-12;  // Negligible beside the curvature.
  constexpr double kHopeless = 1e8;
  constexpr double kEasier = 0.01;
  constexpr double kHarder = 5.0;
  constexpr double kSurely = 0.01;  // So little is left that the step is not worth its evaluation.
  if (!std::isfinite(equations.cost)) return false;
  typename Problem::State trial = state;
  typename Problem::Equations there = equations;
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < limits.iterations && damping < kHopeless; ++iteration) {
    const double converged = limits.absolute + limits.relative * equations.cost;
    const double predicted = problem.step(state, equations, damping, trial);
    // Rounding may make the equations indefinite: such a step leads up.
    if (!(predicted >= 0.0) || !std::isfinite(predicted)) {
      damping *= kHarder;
      continue;
    }
    // A strongly damped step gains little anywhere.
    if (predicted <= kSurely * converged && damping < 1.0) return true;
    problem.assemble(trial, there);
    const double fallen = equations.cost - there.cost;
    if (fallen >= 0.0) {
      std::swap(state, trial);
      std::swap(equations, there);
      damping = std::max(damping * kEasier, kSmallestDamping);
    } else {
      damping *= kHarder;
    }
    // At the optimum the cost cannot fall, and rounding decides its sign, at any damping.
    if (std::abs(fallen) <= converged) return true;
  }
  return false;
}

}  // namespace stickslip::estimate
