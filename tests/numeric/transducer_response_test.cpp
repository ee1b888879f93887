#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/model/transducer.hpp"

namespace stickslip::model {
namespace {

constexpr double kStep_s = 1e-5;

/// What is shown of sin ωt after all else has died away, as gain and phase: least squares over one period.
std::complex<double> response(const Transducer& transducer, double frequency_Hz) {
  TransducerResponse shown{transducer, kStep_s};
  shown.settle(0.0, 0.0);
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  const auto settled = static_cast<long>(std::lround(2.0 / kStep_s));
  const auto period = static_cast<long>(std::lround(1.0 / frequency_Hz / kStep_s));
  std::complex<double> sum;
  for (long step = 1; step <= settled + period; ++step) {
    const double angle = omega * static_cast<double>(step) * kStep_s;
    const double value = shown.next(std::sin(angle));
    if (step > settled) sum += value * std::complex<double>{std::sin(angle), std::cos(angle)};
  }
  return 2.0 / static_cast<double>(period) * sum;
}

/// H(iω) of y″ + 2ζω₀ y′ + ω₀² y = ω₀² x.
std::complex<double> second_order(double ratio, double damping_ratio) {
  return 1.0 / std::complex<double>{1.0 - ratio * ratio, 2.0 * damping_ratio * ratio};
}

// Straight lines in steps of 10 µs: (ω step)²/12 is 1e-5 at 200 Hz.
constexpr double kTolerance = 1e-4;

TEST(TransducerResponse, OfALoadCellIsThatOfItsEquation) {
  for (const double damping_ratio : {0.05, 0.4, kLargestCellDamping}) {
    const Transducer transducer{LoadCellDynamics{80.0, damping_ratio}, {}};
    for (const double frequency_Hz : {20.0, 80.0, 200.0}) {
      EXPECT_LT(
          std::abs(response(transducer, frequency_Hz) - second_order(frequency_Hz / 80.0, damping_ratio)),
          kTolerance)
          << damping_ratio << ", " << frequency_Hz;
    }
  }
}

TEST(TransducerResponse, OfAFilterHasButterworthsGainInEachOrder) {
  for (int order = 1; order <= AntiAlias::kHighestOrder; ++order) {
    const Transducer transducer{{}, AntiAlias{50.0, order}};
    for (const double frequency_Hz : {20.0, 50.0, 100.0}) {
      EXPECT_NEAR(std::abs(response(transducer, frequency_Hz)),
                  1.0 / std::sqrt(1.0 + std::pow(frequency_Hz / 50.0, 2 * order)), kTolerance)
          << order << ", " << frequency_Hz;
    }
  }
}

TEST(TransducerResponse, OfBothIsTheirProduct) {
  const std::complex<double> cell = response({LoadCellDynamics{120.0, 0.05}, {}}, 50.0);
  const std::complex<double> filter = response({{}, AntiAlias{60.0, 4}}, 50.0);
  const std::complex<double> both = response({LoadCellDynamics{120.0, 0.05}, AntiAlias{60.0, 4}}, 50.0);
  EXPECT_LT(std::abs(both - cell * filter), kTolerance);
}

// A line is shown late and else as it is, from the beginning.
TEST(TransducerResponse, SettlesOnALine) {
  TransducerResponse shown{{LoadCellDynamics{120.0, 0.05}, AntiAlias{60.0, 3}}, 1e-3};
  const double rate_per_s = 0.7;
  shown.settle(0.3, rate_per_s);
  EXPECT_NEAR(shown.shown(), 0.3 - rate_per_s * shown.lag_s(), 1e-15);
  for (int step = 1; step < 1000; ++step) {
    const double value = 0.3 + rate_per_s * step * 1e-3;
    EXPECT_NEAR(shown.next(value), value - rate_per_s * shown.lag_s(), 1e-12) << step;
  }
}

TEST(Transducer, IsValidInItsRanges) {
  EXPECT_TRUE(Transducer{}.is_valid());
  EXPECT_TRUE((Transducer{LoadCellDynamics{120.0, 0.0}, AntiAlias{60.0, 8}}.is_valid()));
  for (const LoadCellDynamics& cell : {LoadCellDynamics{0.0, 0.1}, LoadCellDynamics{std::nan(""), 0.1},
                                       LoadCellDynamics{120.0, 1.0}, LoadCellDynamics{120.0, -0.1}})
    EXPECT_FALSE((Transducer{cell, {}}.is_valid()));
  for (const AntiAlias& filter : {AntiAlias{0.0, 4}, AntiAlias{60.0, 0}, AntiAlias{60.0, 9}})
    EXPECT_FALSE((Transducer{{}, filter}.is_valid()));
}

}  // namespace
}  // namespace stickslip::model
