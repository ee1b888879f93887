#include "core/model/oscillator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/accuracy/oscillation50.hpp"

namespace stickslip::model {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

TEST(Oscillator, EntireFunctionsPassThroughZeroWithoutAJump) {
  // Around the place where the series takes over (|z| = 0.01) both forms agree to rounding.
  for (const double z : {0.01, -0.01}) {
    const double inside = std::nextafter(z, 0.0);
    const double outside = z;
    EXPECT_NEAR(entire_cosine(inside, 1.0), entire_cosine(outside, 1.0), 4.0 * kEpsilon);
    EXPECT_NEAR(entire_sine(inside, 1.0), entire_sine(outside, 1.0), 4.0 * kEpsilon);
  }
  EXPECT_EQ(entire_cosine(0.0, 3.0), 1.0);
  EXPECT_EQ(entire_sine(0.0, 3.0), 3.0);
}

TEST(Oscillator, BasisAgreesWithFiftyDigitsFromUnderdampedToOverdamped) {
  const double omega0_squared = 15800.0;
  for (const double gamma : {0.0, 5.0, 251.0, 251.396, 251.39610179, 251.4, 252.0, 400.0, 5000.0}) {
    const Oscillator oscillator = Oscillator::from_omega0(omega0_squared, gamma);
    for (const double t : {1e-9, 1e-4, 0.003, 0.05, 0.5}) {
      const accuracy::Oscillation50 reference{0, 1, 0, gamma, oscillator.omega_squared};
      const accuracy::Oscillation50 sine{0, 0, 1, gamma, oscillator.omega_squared};
      const DampedBasis basis = damped_basis(oscillator, t);
      const double cosine =
          static_cast<double>(reference.value(t) - accuracy::Real(gamma) / 2 * sine.value(t));
      // Arguments γt/2, ωt carry a relative ε, so their functions carry |argument|·ε of their
      // scale; the scale of an overdamped pair is its slow exponential.
      const double argument = gamma * t + std::sqrt(omega0_squared) * t + 1.0;
      const double scale = std::max(std::abs(cosine), std::exp(-gamma * t / 2.0));
      EXPECT_NEAR(basis.cosine, cosine, 4.0 * kEpsilon * argument * scale) << gamma << ' ' << t;
      const double sine_scale = scale * std::min(t, 1.0 / std::sqrt(std::abs(oscillator.omega_squared)));
      EXPECT_NEAR(basis.sine, static_cast<double>(sine.value(t)), 4.0 * kEpsilon * argument * sine_scale)
          << gamma << ' ' << t;
    }
  }
}

TEST(Oscillator, OverdampedBasisNeverOverflows) {
  const Oscillator oscillator = Oscillator::from_omega0(1e4, 1e4);
  const DampedBasis late = damped_basis(oscillator, 1e3);
  EXPECT_TRUE(std::isfinite(late.cosine));
  EXPECT_TRUE(std::isfinite(late.sine));
}

TEST(Oscillator, DampedAndUndampedFrequencyBelongTogether) {
  const Oscillator oscillator = Oscillator::from_omega(125.0, 0.022);
  EXPECT_NEAR(oscillator.omega0_squared(), 125.0 * 125.0 * (1.0 + 0.022 * 0.022), 1e-11);  // [7], [10]
  const Oscillator again = Oscillator::from_omega0(oscillator.omega0_squared(), oscillator.gamma_per_s);
  EXPECT_NEAR(again.omega_rad_per_s(), 125.0, 1e-12);
  EXPECT_FALSE(Oscillator::from_omega0(1.0, 2.0).oscillates());  // Critical: γ = 2ω₀.
}

}  // namespace
}  // namespace stickslip::model
