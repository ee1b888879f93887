// Courses: their calculus by its own theorems, and the response by substitution into the equation.
#include "core/sim/exponential_polynomial.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "core/accuracy/oscillation50.hpp"
#include "tests/numeric/constants.hpp"

namespace stickslip::numeric {
namespace {

using accuracy::Real;
using sim::ExponentialPolynomial;

constexpr std::array kTimes_s{0.0, 1e-9, 1e-3, 0.04, 0.7, 3.0};

/// A bit of everything.
ExponentialPolynomial some_course(double slow_rate = 0.3, double fast_rate = 40.0) {
  ExponentialPolynomial course{0.3};
  course.add_power(1, -0.02);
  course.add_power(3, 0.5);
  course.add_decay(slow_rate, 2, 0.7);
  course.add_decay(slow_rate, 0, -0.1);
  course.add_decay(fast_rate, 1, 2.0);
  return course;
}

// φ_m = ∫φ_(m−1): in 50 digits (1 − e^(−z))/λ … cancel, but only half of the digits at z = 1e-9.
TEST(ExponentialPolynomial, IntegralsOfDecaysKeepTheirDigits) {
  for (const double rate : {1e-9, 1e-3, 0.9, 1.1, 37.0, -0.5, -3.0}) {
    for (const double t_s : {1e-6, 0.04, 0.99, 1.3, 6.0}) {
      std::array<Real, 5> phi;
      const Real lambda = rate;
      phi[0] = exp(-lambda * Real(t_s));
      Real power = 1;
      for (std::size_t m = 1; m < 5; ++m) {
        phi.at(m) = (power - phi.at(m - 1)) / lambda;
        power *= Real(t_s) / m;
      }
      const auto found = sim::decay_integrals(rate, t_s, 5);
      for (std::size_t m = 0; m < 5; ++m) {
        // φ₄ at λt = 1e-15 has lost 60 of 50 digits in the reference.
        if (m > 2 && std::abs(rate * t_s) < 1e-6) continue;
        // Above λt = 1 each step up multiplies the rounding by less than 1 + e.
        EXPECT_NEAR(found.at(m) / static_cast<double>(phi.at(m)), 1.0, 200.0 * kEpsilon)
            << rate << " " << t_s << " " << m;
      }
    }
  }
}

TEST(ExponentialPolynomial, DerivativeUndoesIntegral) {
  const ExponentialPolynomial course = some_course();
  const ExponentialPolynomial same = course.integral().derivative();
  for (const double t_s : kTimes_s) {
    EXPECT_NEAR(same.value(t_s), course.value(t_s), 8.0 * kEpsilon * course.magnitude(t_s)) << t_s;
  }
  EXPECT_EQ(course.integral().value(0.0), 0.0);
}

TEST(ExponentialPolynomial, LaterIsTheSameCourse) {
  for (const double by_s : kTimes_s) {
    const ExponentialPolynomial later = some_course().later(by_s);
    for (const double t_s : kTimes_s) {
      // The times themselves are rounded sums.
      EXPECT_NEAR(later.value(t_s), some_course().value(by_s + t_s),
                  40.0 * kEpsilon * (1.0 + some_course().magnitude(by_s + t_s)))
          << by_s << " " << t_s;
    }
  }
}

TEST(ExponentialPolynomial, OperatorRemovesADecay) {
  const ExponentialPolynomial course = some_course();
  const ExponentialPolynomial without = course.without_decay(0);
  ASSERT_EQ(without.decays(), 1);
  const ExponentialPolynomial derivative = course.derivative();
  for (const double t_s : kTimes_s) {
    const double expected = derivative.value(t_s) + 0.3 * course.value(t_s);
    EXPECT_NEAR(without.value(t_s), expected, 40.0 * kEpsilon * (1.0 + derivative.magnitude(t_s)));
  }
}

// p″ + γp′ + ω₀²p − ω₀²K = 0, from weak damping through critical to twice critical.
TEST(ExponentialPolynomial, ResponseSolvesTheOscillatorsEquation) {
  const double omega0 = 125.0;
  for (const double damping : {0.0, 0.044, 1.9, 2.0, 2.1, 4.0}) {
    const auto oscillator = model::Oscillator::from_omega0(omega0 * omega0, damping * omega0);
    for (const double rate : {1e-9, 0.3, -0.2}) {
      const ExponentialPolynomial drive = some_course(rate);
      const ExponentialPolynomial p = drive.response(oscillator);
      const ExponentialPolynomial rate_of_p = p.derivative();
      const ExponentialPolynomial slope = rate_of_p.derivative();
      for (const double t_s : kTimes_s) {
        const double residual = slope.value(t_s) / (omega0 * omega0) +
                                oscillator.gamma_per_s * rate_of_p.value(t_s) / (omega0 * omega0) +
                                p.value(t_s) - drive.value(t_s);
        EXPECT_NEAR(residual, 0.0, 100.0 * kEpsilon * (1.0 + drive.magnitude(t_s)))
            << damping << " " << rate << " " << t_s;
      }
    }
  }
}

TEST(ExponentialPolynomial, ResonanceIsWhereAnOverdampedOscillatorDecaysByItself) {
  // λ² − γλ + ω₀² = 0 at λ = γ/2 ± κ: 1 and 4 for γ = 5, ω₀² = 4.
  const auto oscillator = model::Oscillator::from_omega0(4.0, 5.0);
  EXPECT_EQ(sim::distance_from_resonance(1.0, oscillator), 0.0);
  EXPECT_EQ(sim::distance_from_resonance(4.0, oscillator), 0.0);
  EXPECT_EQ(sim::distance_from_resonance(0.0, oscillator), 1.0);
}

}  // namespace
}  // namespace stickslip::numeric
