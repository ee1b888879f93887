// When a contact gives way, where the belt's speed or the limit itself changes.
#include <cmath>

#include "core/sim/bracket.hpp"
#include "core/sim/first_rise.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::sim {

namespace {

/// Steps towards an ageing limit from below; each takes the growth of the step before into account.
constexpr int kAgeingSteps = 200;
/// Where a step is this small beside the time itself, the rest is bracketed.
constexpr double kLastStep = 1e-6;
constexpr double kRounding = 1e-13;  // Of a sum of a few courses.

}  // namespace

/// First time at which ±held reaches S.
std::optional<double> Propagator::gives_way_s(const ExponentialPolynomial& held, double side,
                                              double from_s) const {
  ExponentialPolynomial excess = held.scaled(side);
  excess += factor_.scaled(-paper_.now().mu_k);
  excess.add_power(0, -(paper_.now().mu_s - paper_.now().mu_k));
  const double end_s = longest_s();
  const double rested = rested_s();
  const auto growth = [&](double t_s) { return paper_.growth(rested + t_s); };
  if (growth(end_s) == 0.0) return first_rise_s({{}, excess}, from_s, end_s, Touch::kDoesNot);

  // S only grows: the first time at which the force reaches what S is at t comes never after the first
  // time at which it reaches S, whatever t before that is taken.
  const auto above = [&](double t_s) { return excess.value(t_s) - growth(t_s); };
  double t_s = from_s;
  for (int step = 0; step < kAgeingSteps; ++step) {
    ExponentialPolynomial frozen = excess;
    frozen.add_power(0, -growth(t_s));
    const auto reached_s = first_rise_s({{}, frozen}, t_s, end_s, Touch::kDoesNot);
    if (!reached_s) return std::nullopt;
    const double step_s = *reached_s - t_s;
    t_s = *reached_s;
    if (above(t_s) >= 0.0 || t_s >= end_s) return t_s;
    if (step > 0 && step_s < kLastStep * t_s) {
      const double high_s = std::fmin(end_s, t_s + step_s);
      if (above(high_s) >= 0.0) return rise_between(above, t_s, high_s);
    }
  }
  return t_s;
}

std::optional<double> Propagator::stick_gives_way_s(double side) const {
  const double gamma = motion_.oscillator.gamma_per_s;
  ExponentialPolynomial held = course_;
  held += rate_.derivative().scaled(1.0 / omega0_squared_);
  const ExponentialPolynomial damper = rate_.scaled(gamma / omega0_squared_);
  ExponentialPolynomial driven = held;
  driven += damper;
  if (motion_.damper_counts_at_onset) held = driven;
  if (motion_.damper_counts_at_onset || gamma == 0.0) return gives_way_s(held, side, 0.0);

  // Where the damper alone keeps the sled at the belt's speed, it stays there beyond the limit, until spring
  // and damper together exceed K too.
  ExponentialPolynomial drive = driven.scaled(side);
  drive += factor_.scaled(-paper_.now().mu_k);
  const auto limit = [&](double t_s) {
    const Coefficients& contact = paper_.now();
    return contact.mu_s + contact.mu_k * (factor_.value(t_s) - 1.0) + paper_.growth(rested_s() + t_s);
  };
  double t_s = 0.0;
  if (side * held.value(0.0) <= limit(0.0) * (1.0 + kRounding)) {
    const auto reached_s = gives_way_s(held, side, 0.0);
    if (!reached_s) return std::nullopt;
    t_s = *reached_s;
  }
  while (drive.value(t_s) < -kRounding * drive.magnitude(t_s)) {
    const auto driven_s = first_rise_s({{}, drive}, t_s, longest_s(), Touch::kDoesNot);
    if (!driven_s || side * held.value(*driven_s) >= limit(*driven_s)) return driven_s;
    const auto reached_s = gives_way_s(held, side, *driven_s);
    if (!reached_s) return std::nullopt;
    t_s = *reached_s;
  }
  return t_s;
}

}  // namespace stickslip::sim
