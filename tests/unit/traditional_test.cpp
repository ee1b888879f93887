#include "core/analysis/traditional.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

namespace stickslip::analysis {
namespace {

constexpr double kScanRate_Hz = 350.0;
constexpr int kPeriod = 20;  // scans, so that peaks lie on scans
constexpr int kFirstPeak = 10;

estimate::Trace trace_of(const std::vector<double>& values) {
  estimate::Trace trace;
  trace.value = values;
  trace.usable.assign(trace.value.size(), 1);
  for (std::size_t k = 0; k < trace.value.size(); ++k) {
    trace.time_s.push_back(static_cast<double>(k) / kScanRate_Hz);
  }
  return trace;
}

/// 0.3 + 0.05 cos about the peaks at 10, 30, 50 …
estimate::Trace oscillation(int scans) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(scans));
  for (int k = 0; k < scans; ++k) {
    values.push_back(0.3 + 0.05 * std::cos(2.0 * std::numbers::pi * (k - kFirstPeak) / kPeriod));
  }
  return trace_of(values);
}

std::vector<detect::Fall> slips_at_the_peaks(int count) {
  std::vector<detect::Fall> slips;
  for (int i = 0; i < count; ++i) {
    detect::Fall slip;
    slip.peak_at = kFirstPeak + kPeriod * i;
    slip.trough_at = slip.peak_at + 0.5 * kPeriod;
    slip.peak = 0.35;
    slip.trough = 0.25;
    slips.push_back(slip);
  }
  return slips;
}

TEST(Traditional, StaticIsTheLargestScanOfTheFirstPeak) {
  estimate::Trace trace = oscillation(400);
  trace.value[11] = 0.37;  // beside the interpolated maximum
  trace.value[30] = 0.40;  // another peak
  const TraditionalCoefficients found = traditional_coefficients(trace, slips_at_the_peaks(15), {});
  EXPECT_EQ(found.static_coefficient.value, 0.37);
}

TEST(Traditional, KineticIsNoMeanOverAHold) {
  estimate::Trace trace = oscillation(400);
  for (std::size_t k = 100; k < 130; ++k) trace.value[k] = 0.2;
  // Between scans 99 and 100, and 129 and 130.
  const double stop_s = 99.5 / kScanRate_Hz;
  const double go_s = 129.5 / kScanRate_Hz;
  const auto held =
      model::PullSpeed::make({{0.0, 0.005}, {stop_s, 0.005}, {stop_s, 0.0}, {go_s, 0.0}, {go_s, 0.005}});
  trace.belt = model::BeltMotion{*held, 0.0};
  std::vector<double> pulled;
  for (std::size_t k = kFirstPeak; k < kFirstPeak + 10 * kPeriod; ++k) {
    if (k < 100 || k >= 130) pulled.push_back(trace.value[k]);
  }
  const double mean = std::accumulate(pulled.begin(), pulled.end(), 0.0) / static_cast<double>(pulled.size());
  const TraditionalCoefficients found = traditional_coefficients(trace, slips_at_the_peaks(15), {});
  EXPECT_NEAR(*found.kinetic_coefficient.value, mean, 1e-12);
}

TEST(Traditional, TraceThatBeginsWhileTheSledSlidesIsKnown) {
  EXPECT_TRUE(begins_under_load(oscillation(400)));
  std::vector<double> values(5, 0.0);
  values.resize(100, 0.3);
  EXPECT_FALSE(begins_under_load(trace_of(values)));
  values[0] = values[4] = 0.5;  // Spikes.
  EXPECT_FALSE(begins_under_load(trace_of(values)));
  values[2] = 0.5;
  EXPECT_TRUE(begins_under_load(trace_of(values)));
}

TEST(Traditional, KineticIsTheMeanOfTenWholeCycles) {
  // A sampled cosine over whole cycles has mean 0 up to 200 roundings of 0.35 (6e-17 each, averaged).
  const TraditionalCoefficients found =
      traditional_coefficients(oscillation(400), slips_at_the_peaks(15), {});
  EXPECT_NEAR(found.kinetic_coefficient.value.value(), 0.3, 1e-14);
}

TEST(Traditional, KineticTakesTheMethodsCyclesAndNoMore) {
  // The level is i/10 in cycle i: the mean of n cycles is (n − 1)/20.
  estimate::Trace trace = oscillation(400);
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const std::size_t cycle = k < kFirstPeak ? 90 : (k - kFirstPeak) / kPeriod;
    trace.value[k] = 0.1 * static_cast<double>(cycle);
  }
  for (const int cycles : {1, 3, 10}) {
    model::Method method;
    method.kinetic_cycles = cycles;
    const TraditionalCoefficients found = traditional_coefficients(trace, slips_at_the_peaks(15), method);
    EXPECT_NEAR(found.kinetic_coefficient.value.value(), (cycles - 1) / 20.0, 1e-12) << cycles;
  }
}

TEST(Traditional, StaticIsThePeakOfTheMethodsSlip) {
  estimate::Trace trace = oscillation(400);
  trace.value[kFirstPeak + 2 * kPeriod] = 0.41;
  model::Method method;
  method.static_slip = 3;
  EXPECT_EQ(traditional_coefficients(trace, slips_at_the_peaks(15), method).static_coefficient.value, 0.41);
  const Estimate absent = traditional_coefficients(trace, slips_at_the_peaks(2), method).static_coefficient;
  EXPECT_FALSE(absent.value);
  EXPECT_EQ(absent.reason, "2 slips, the method reads the peak of slip 3");
}

// One metre is a second, so 350 scans; the value is the time since the first peak.
TEST(Traditional, KineticIsTheMeanOverTheMethodsTravelAfterTheFirstPeak) {
  estimate::Trace trace = oscillation(400);
  for (std::size_t k = 0; k < trace.size(); ++k) {
    trace.value[k] = trace.time_s[k] - kFirstPeak / kScanRate_Hz;
  }
  model::Method method;
  method.kinetic_travel = model::TravelWindow{0.2, 0.8};
  const auto kinetic = [&](std::optional<double> speed_m_per_s) {
    return traditional_coefficients(trace, slips_at_the_peaks(15), method, speed_m_per_s).kinetic_coefficient;
  };
  // The mean time of the window; its ends fall between scans by up to one of them.
  EXPECT_NEAR(kinetic(1.0).value.value(), 0.5, 1.0 / kScanRate_Hz);
  EXPECT_NEAR(kinetic(2.0).value.value(), 0.25, 1.0 / kScanRate_Hz);
  EXPECT_FALSE(kinetic({}).value);
  EXPECT_EQ(kinetic({}).reason, "the method averages over a travel, and the pull speed is not known");
  EXPECT_FALSE(kinetic(0.5).value);
  EXPECT_EQ(kinetic(0.5).reason, "0.5557 m of travel after the first peak, the method wants 0.8 m");
}

TEST(Traditional, TravelOfSteadySlidingCountsFromTheEndOfTheLoading) {
  std::vector<double> values(100, 0.0);
  values.insert(values.end(), 350, 0.3);
  values.insert(values.end(), 350, 0.2);
  model::Method method;
  method.kinetic_travel = model::TravelWindow{0.0, 2.0};
  const TraditionalCoefficients found = traditional_coefficients(trace_of(values), {}, method, 1.5);
  // 2 m last 4/3 s: 350 scans of 0.3, then a third of that of 0.2 (116 or 117).
  EXPECT_NEAR(found.kinetic_coefficient.value.value(), (0.3 * 350 + 0.2 * 116.67) / 466.67, 1e-4);
}

TEST(Traditional, OscillationThatDiesAwayGoesOnWithItsMeanPeriod) {
  estimate::Trace trace = oscillation(400);
  for (std::size_t k = kFirstPeak + 3 * kPeriod; k < trace.size(); ++k) trace.value[k] = 0.2;
  const TraditionalCoefficients found = traditional_coefficients(trace, slips_at_the_peaks(4), {});
  // Three cycles of mean 0.3 and seven of 0.2.
  EXPECT_NEAR(found.kinetic_coefficient.value.value(), 0.23, 1e-12);
}

TEST(Traditional, TraceThatEndsTooEarlyHasNoKineticCoefficient) {
  const TraditionalCoefficients found =
      traditional_coefficients(oscillation(kFirstPeak + 5 * kPeriod), slips_at_the_peaks(4), {});
  EXPECT_TRUE(found.static_coefficient.value);
  EXPECT_FALSE(found.kinetic_coefficient.value);
  EXPECT_EQ(found.kinetic_coefficient.reason, "3 cycles after the first peak, the method wants 10");
}

TEST(Traditional, OnePeakHasNoCycle) {
  const TraditionalCoefficients found = traditional_coefficients(oscillation(400), slips_at_the_peaks(1), {});
  EXPECT_EQ(found.static_coefficient.value, 0.3 + 0.05);
  EXPECT_FALSE(found.kinetic_coefficient.value);
  EXPECT_FALSE(found.kinetic_coefficient.reason.empty());
}

TEST(Traditional, UnusableScansAreLeftOutOfTheMean) {
  estimate::Trace trace = oscillation(400);
  // A pair half a period apart, so that the others still average to 0.3.
  for (const std::size_t k : {45U, 55U}) {
    trace.value[k] = 5.0;
    trace.usable[k] = 0;
  }
  const TraditionalCoefficients found = traditional_coefficients(trace, slips_at_the_peaks(15), {});
  EXPECT_NEAR(found.kinetic_coefficient.value.value(), 0.3, 1e-14);
}

TEST(Traditional, AWindowWithoutAUsableScanSaysSo) {
  estimate::Trace trace = oscillation(400);
  const auto reason = [&] {
    return traditional_coefficients(trace, slips_at_the_peaks(15), {}).kinetic_coefficient.reason;
  };
  trace.usable.assign(trace.size(), 0);
  EXPECT_EQ(reason(), "no scan of the window is usable");
  trace.usable.assign(trace.size(), 1);
  const auto late = model::PullSpeed::make({{0.0, 0.0}, {9.0, 0.0}, {9.0, 0.005}});
  trace.belt = model::BeltMotion{*late, 0.0};
  EXPECT_EQ(reason(), "the belt stood still in the whole window");
}

TEST(Traditional, SteadySlidingAveragesWithoutLoadingAndUnloading) {
  std::vector<double> values(100, 0.0);
  for (int k = 0; k < 30; ++k) values.push_back(0.01 * k);
  values.insert(values.end(), 1000, 0.3);
  values.insert(values.end(), 100, 0.0);
  const TraditionalCoefficients found = traditional_coefficients(trace_of(values), {}, {});
  EXPECT_FALSE(found.static_coefficient.value);
  EXPECT_FALSE(found.static_coefficient.reason.empty());
  // From half of 0.3 on: 15 scans of the loading (14 if 0.15 rounds below), mean 0.22, and 1000 of 0.3.
  EXPECT_NEAR(found.kinetic_coefficient.value.value(), (15 * 0.22 + 1000 * 0.3) / 1015.0, 2e-4);
}

TEST(Traditional, TraceBelowZeroAndOneScan) {
  EXPECT_NEAR(traditional_coefficients(trace_of({-0.2, -0.2}), {}, {}).kinetic_coefficient.value.value(),
              -0.2, 1e-15);
  EXPECT_EQ(traditional_coefficients(trace_of({0.3}), {}, {}).kinetic_coefficient.value, 0.3);
}

}  // namespace
}  // namespace stickslip::analysis
