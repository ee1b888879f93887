// What the unloaded tester is told to say is what was put into its scans.

#include "core/pipeline/self_check.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stickslip::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRate_Hz = 350.0;
constexpr double kLoad_N = 22.86;  // 2331 g.
constexpr unsigned kSeed = 20261122;

/// A 16-bit converter of ±10 V on a cell of 2 N/V.
daq::Calibration calibration() {
  daq::BoardInfo board;
  board.maxdata = 65535;
  board.polynomial = {-10.0, 20.0 / 65535.0};
  return {board, {2.0, 0.0}, kLoad_N};
}

struct Idle {
  double zero_N = 0.0;
  double drift_N_per_s = 0.0;
  double hum_N = 0.0;
  double hum_Hz = 50.0;
  double noise_N = 0.01;
};

/// Codes, not rounded: what rounding adds is in other tests.
std::vector<double> scans(const Idle& idle, std::size_t count, unsigned seed = kSeed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0.0, idle.noise_N};
  std::vector<double> raw;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = static_cast<double>(i) / kRate_Hz;
    const double force_N = idle.zero_N + idle.drift_N_per_s * time_s +
                           idle.hum_N * std::sin(2.0 * std::numbers::pi * idle.hum_Hz * time_s + 1.0) +
                           noise(random);
    raw.push_back((force_N / 2.0 + 10.0) * 65535.0 / 20.0);
  }
  return raw;
}

daq::SelfCheck checked(const std::vector<double>& raw) {
  return check_idle(100, raw, calibration(), kRate_Hz);
}

/// 4.5 standard errors: of some 3000 draws below one in a hundred thousand runs leaves it by chance.
constexpr double kErrors = 4.5;

TEST(SelfCheck, FindsWhatWasPutIn) {
  const Idle idle{0.03, 0.0008, 0.05, 60.0, 0.01};
  const daq::SelfCheck check = checked(scans(idle, 1750));
  EXPECT_EQ(check.first_scan, 100);
  EXPECT_NEAR(*check.drift_N_per_s, idle.drift_N_per_s, kErrors * *check.drift_standard_error_N_per_s);
  // Of the middle of the scans.
  EXPECT_NEAR(*check.zero_N, idle.zero_N + idle.drift_N_per_s * 1749.0 / 2.0 / kRate_Hz,
              kErrors * *check.zero_standard_error_N);
  EXPECT_NEAR(*check.hum_at_60_Hz_N, idle.hum_N, kErrors * *check.hum_standard_error_N);
  EXPECT_LT(*check.hum_at_50_Hz_N, kErrors * *check.hum_standard_error_N);
  // σ of n normal deviates is known to 1/√(2n).
  EXPECT_NEAR(*check.noise_N, idle.noise_N, kErrors * idle.noise_N / std::sqrt(2.0 * 1744.0));
  EXPECT_EQ(check.spike_count, 0);
  EXPECT_EQ(check.saturated_count, 0);
  EXPECT_THAT(check.findings, IsEmpty());
}

TEST(SelfCheck, StandardErrorsAreThoseOfRepeatedChecks) {
  constexpr int kChecks = 200;
  double squares_zero = 0.0;
  double squares_drift = 0.0;
  for (unsigned i = 0; i < kChecks; ++i) {
    const daq::SelfCheck check = checked(scans({}, 350, kSeed + i));
    squares_zero += std::pow(*check.zero_N / *check.zero_standard_error_N, 2);
    squares_drift += std::pow(*check.drift_N_per_s / *check.drift_standard_error_N_per_s, 2);
  }
  // χ² of 200: mean 200, standard deviation 20.
  EXPECT_NEAR(squares_zero, kChecks, kErrors * 20.0);
  EXPECT_NEAR(squares_drift, kChecks, kErrors * 20.0);
}

TEST(SelfCheck, TellsWhatSomebodyShouldLookAt) {
  EXPECT_THAT(checked(scans({0.5, 0.0, 0.0, 50.0, 0.01}, 1750)).findings,
              ElementsAre(HasSubstr("unloaded cell reads 0.5 N")));
  EXPECT_THAT(checked(scans({0.0, 0.01, 0.0, 50.0, 0.001}, 1750)).findings,
              ElementsAre(HasSubstr("zero drifts by 0.6 N in a minute")));
  EXPECT_THAT(checked(scans({0.0, 0.0, 0.2, 50.0, 0.01}, 1750)).findings,
              ElementsAre(HasSubstr("hum of 0.2 N at 50 Hz")));
  EXPECT_THAT(checked(scans({0.0, 0.0, 0.0, 50.0, 0.2}, 1750)).findings,
              ElementsAre(HasSubstr("noise of 0.2 N")));
  std::vector<double> railed = scans({}, 1750);
  railed[7] = 0.0;
  EXPECT_THAT(checked(railed).findings, ElementsAre(HasSubstr("at a rail with no load, 1 of 1750")));
  std::vector<double> spiky = scans({}, 350);
  for (std::size_t i = 5; i < spiky.size(); i += 7) spiky[i] += 2000.0;
  EXPECT_THAT(checked(spiky).findings, testing::Contains(HasSubstr("50 spikes in 1 s")));
}

TEST(SelfCheck, SpikesDoNotMoveTheRest) {
  const std::vector<double> clean = scans({}, 700);
  std::vector<double> spiky = clean;
  for (const std::size_t i : {100U, 300U, 500U}) spiky[i] += 3000.0;
  const daq::SelfCheck check = checked(spiky);
  EXPECT_EQ(check.spike_count, 3);
  EXPECT_NEAR(*check.zero_N, *checked(clean).zero_N, 3.0 * 3.0 * 0.01 / 700.0);  // Three replaced scans.
}

TEST(SelfCheck, RateOfTheClockBesideTheGranted) {
  const std::vector<double> raw = scans({}, 350);
  const auto with = [&](double rate_Hz, double error_Hz) {
    return check_idle(0, raw, calibration(), kRate_Hz, daq::RateEstimate{rate_Hz, error_Hz, 10});
  };
  EXPECT_THAT(with(350.1, 1e-3).findings, IsEmpty());
  EXPECT_THAT(with(351.0, 1e-3).findings, ElementsAre(HasSubstr("351 Hz by the computer's clock")));
  EXPECT_THAT(with(351.0, 1.0).findings, IsEmpty());  // Not known well enough.
  EXPECT_EQ(with(351.0, 1.0).scan_rate_Hz, 351.0);
}

TEST(SelfCheck, TooFewScansTellNothing) {
  const daq::SelfCheck few = checked(scans({}, kFewestIdleScans - 1));
  EXPECT_FALSE(few.zero_N);
  EXPECT_FALSE(few.noise_N);
  EXPECT_FALSE(few.spike_count);
  EXPECT_EQ(few.saturated_count, 0);
  // 100 Hz cannot show 60.
  const daq::SelfCheck slow = check_idle(0, scans({}, 200), calibration(), 100.0);
  EXPECT_TRUE(slow.noise_N);
  EXPECT_FALSE(slow.hum_at_50_Hz_N);
}

TEST(IdleScans, KeepTheLatestAndBeginAnewAtAJump) {
  IdleScans idle{kRate_Hz};
  EXPECT_FALSE(idle.check(calibration(), {}));
  for (base::ScanIndex i = 0; i < 3000; ++i) idle.add(i, 32768.0);
  const auto full = idle.check(calibration(), {});
  ASSERT_TRUE(full);
  EXPECT_EQ(full->raw.size(), 1750U);  // 5 s.
  EXPECT_EQ(full->first_scan, 1250);
  idle.add(3005, 32768.0);
  EXPECT_EQ(idle.check(calibration(), {})->first_scan, 3005);
  idle.clear();
  EXPECT_FALSE(idle.check(calibration(), {}));
}

}  // namespace
}  // namespace stickslip::pipeline
