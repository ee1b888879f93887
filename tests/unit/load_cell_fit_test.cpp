#include "core/daq/load_cell_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/sample_limits.hpp"

namespace stickslip::daq {
namespace {

constexpr double kGain_N_per_V = 4.0;
constexpr double kZero_V = 0.5;
constexpr double kGravity_m_per_s2 = 9.80665;

LoadPoint exact(double force_N) { return {force_N, kZero_V + force_N / kGain_N_per_V}; }

// Hard case 19.

TEST(LoadCellFit, OneWeightIsNotEnough) {
  for (const std::vector<LoadPoint>& points : {std::vector<LoadPoint>{},
                                               {exact(8.0)},
                                               {exact(8.0), exact(8.0)},
                                               {exact(0.1), exact(0.1), exact(0.1)}}) {
    const LoadCellFit fit = fit_load_cell(points);
    EXPECT_FALSE(fit.load_cell);
    EXPECT_FALSE(fit.reason.empty());
  }
}

TEST(LoadCellFit, TwoWeightsGiveALineWithoutAnError) {
  const LoadCellFit fit = fit_load_cell(std::vector<LoadPoint>{exact(0.0), exact(8.0)});
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  EXPECT_DOUBLE_EQ(fit.load_cell->gain_N_per_V, kGain_N_per_V);
  EXPECT_DOUBLE_EQ(fit.load_cell->zero_V, kZero_V);
  EXPECT_FALSE(fit.gain_standard_error_N_per_V);
}

TEST(LoadCellFit, TwoEqualWeightsCountAsOftenAsTheyWereRead) {
  // Readings of 8 N scatter by ±0.1 V about the line: their mean lies on it.
  std::vector<LoadPoint> points{exact(0.0), exact(8.0), exact(8.0)};
  points[1].voltage_V += 0.1;
  points[2].voltage_V -= 0.1;
  const LoadCellFit fit = fit_load_cell(points);
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  EXPECT_NEAR(fit.load_cell->gain_N_per_V, kGain_N_per_V, 1e-14);
  EXPECT_NEAR(*fit.residual_V, std::sqrt(0.02), 1e-15);  // One degree of freedom.
}

TEST(LoadCellFit, MilligramBesideTenKilogramsKeepsItsDigits) {
  const std::vector<LoadPoint> points{exact(0.0), exact(1e-6 * kGravity_m_per_s2),
                                      exact(10.0 * kGravity_m_per_s2)};
  const LoadCellFit fit = fit_load_cell(points);
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  // Voltages of 25 V are rounded to 2⁻⁴⁹ V.
  EXPECT_NEAR(fit.load_cell->gain_N_per_V, kGain_N_per_V, 4.0 * 0x1p-49);
  EXPECT_NEAR(fit.load_cell->zero_V, kZero_V, 0x1p-48);
}

TEST(LoadCellFit, HysteresisIsWhatFallingLoadsReadMore) {
  std::vector<LoadPoint> points;
  for (const double force_N : {0.0, 4.0, 8.0, 12.0, 16.0}) points.push_back(exact(force_N));
  for (const double force_N : {12.0, 8.0, 4.0, 0.0}) {
    points.push_back(exact(force_N));
    points.back().voltage_V += 0.01;
  }
  const LoadCellFit fit = fit_load_cell(points);
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  // The line takes part of the difference where rising loads are heavier in the mean: 10 N against 6 N.
  EXPECT_NEAR(*fit.hysteresis_V, 0.01, 0.002);
  EXPECT_LT(*fit.residual_V, 0.01);
}

TEST(LoadCellFit, LoadThatIsReadTwiceNeitherRisesNorFalls) {
  // Only the second reading of 8 N is off, by 0.1 V: the line passes between the two. The rising load reads
  // 0.05 V less than the line, the falling one is on it, and the second reading belongs to neither.
  std::vector<LoadPoint> points{exact(0.0), exact(8.0), exact(8.0), exact(0.0)};
  points[2].voltage_V += 0.1;
  const LoadCellFit fit = fit_load_cell(points);
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  EXPECT_NEAR(*fit.hysteresis_V, 0.05, 1e-14);
}

TEST(LoadCellFit, HysteresisNeedsLoadsThatFall) {
  for (const double sign : {1.0, -1.0}) {
    const LoadCellFit fit =
        fit_load_cell(std::vector<LoadPoint>{exact(sign * -8.0), exact(0.0), exact(sign * 8.0)});
    ASSERT_TRUE(fit.load_cell) << fit.reason;
    EXPECT_FALSE(fit.hysteresis_V);
  }
}

TEST(LoadCellFit, CellIsWhatFollowsTheLoadByThreeStandardErrors) {
  // Residuals of d, −2d, d about a line through three loads 8 N apart: variance 6 d² with one degree of
  // freedom, Σ (N − N̄)² = 2 · 8² N², so the sensitivity has the standard error √3 d / 8 N.
  for (const auto& [standard_errors, is_cell] : {std::pair{3.1, true}, std::pair{2.9, false}}) {
    const double d = 8.0 / kGain_N_per_V / (standard_errors * std::sqrt(3.0));
    std::vector<LoadPoint> points{exact(0.0), exact(8.0), exact(16.0)};
    points[0].voltage_V += d;
    points[1].voltage_V -= 2.0 * d;
    points[2].voltage_V += d;
    EXPECT_EQ(fit_load_cell(points).load_cell.has_value(), is_cell) << standard_errors;
  }
}

TEST(LoadCellFit, SaturatedPointsDoNotCount) {
  std::vector<LoadPoint> points{exact(0.0), exact(8.0), exact(16.0), {80.0, 10.0, true}};
  const LoadCellFit fit = fit_load_cell(points);
  ASSERT_TRUE(fit.load_cell) << fit.reason;
  EXPECT_EQ(fit.used, 3);
  EXPECT_DOUBLE_EQ(fit.load_cell->gain_N_per_V, kGain_N_per_V);
  for (LoadPoint& point : points) point.saturated = true;
  EXPECT_NE(fit_load_cell(points).reason.find("4 saturated"), std::string::npos);
}

TEST(LoadCellFit, WireThatIsOffIsSaid) {
  const std::vector<LoadPoint> flat{{0.0, 0.1}, {8.0, 0.1}, {16.0, 0.1}};
  EXPECT_NE(fit_load_cell(flat).reason.find("does not follow"), std::string::npos);
  const std::vector<LoadPoint> noise{{0.0, 0.1}, {8.0, -0.1}, {16.0, 0.1}, {24.0, -0.05}};
  EXPECT_NE(fit_load_cell(noise).reason.find("does not follow"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fit_load_cell(std::vector<LoadPoint>{{0.0, 0.1}, {8.0, nan}}).load_cell);
}

TEST(LoadCellFit, StandardErrorsAreThoseOfTheScatter) {
  // Errors over standard errors follow Student's t with 4 degrees of freedom, whose variance has no variance;
  // but |t| is below 2.776 in 95 % of trials.
  std::mt19937_64 engine{19};
  std::normal_distribution<double> normal{0.0, 0.01};
  constexpr int kTrials = 300;
  int gain_inside = 0;
  int zero_inside = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<LoadPoint> points;
    for (const double force_N : {0.0, 2.0, 4.0, 8.0, 4.0, 0.0}) {
      points.push_back(exact(force_N));
      points.back().voltage_V += normal(engine);
    }
    const LoadCellFit fit = fit_load_cell(points);
    ASSERT_TRUE(fit.load_cell);
    const auto inside = [](double off, double error) { return std::abs(off) <= 2.776 * error; };
    gain_inside +=
        inside(fit.load_cell->gain_N_per_V - kGain_N_per_V, *fit.gain_standard_error_N_per_V) ? 1 : 0;
    zero_inside += inside(fit.load_cell->zero_V - kZero_V, *fit.zero_standard_error_V) ? 1 : 0;
  }
  for (const int count : {gain_inside, zero_inside}) {
    EXPECT_GE(count, test::lowest_count(kTrials, 0.95));
    EXPECT_LE(count, test::highest_count(kTrials, 0.95));
  }
}

}  // namespace
}  // namespace stickslip::daq
