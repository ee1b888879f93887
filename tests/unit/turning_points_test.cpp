#include "core/detect/turning_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "core/model/slip_waveform.hpp"

namespace stickslip::estimate {
namespace {

constexpr double kLineScan_s = 1.0 / 350.0;
constexpr double kNoise = 1e-3;
constexpr double kLineSlope = 16.0;
/// The line in binary64: coordinates of about 1, over a time of at least five scans.
constexpr double kLineRounding = 1e-13;

std::vector<CyclePoint> line_of(std::size_t count) {
  std::vector<CyclePoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = 3.0 + static_cast<double>(i) * kLineScan_s;
    points[i] = {.time_s = time_s,
                 .value = kLineSlope * (time_s - 3.0),
                 .spread_s2 = 0.0,
                 .count = 1.0,
                 .first_s = time_s,
                 .last_s = time_s};
  }
  return points;
}

double slope_within(const std::vector<CyclePoint>& points) {
  return detect::slope_between(points, -1.0, 2.0, kNoise).value_or(std::nan(""));
}

// A fast loading has half a dozen scans, and a spike may stand on any of them, up or down.
TEST(SlopeBetween, OneStrayOfSixBendsNothing) {
  for (std::size_t at = 0; at < 6; ++at) {
    for (const double spike : {-0.5, -0.05, 0.05, 0.5}) {
      std::vector<CyclePoint> points = line_of(6);
      points[at].value += spike;
      EXPECT_NEAR(slope_within(points), kLineSlope, kLineRounding * kLineSlope) << at << ' ' << spike;
    }
  }
}

// 29 % of the points may stray [Sen 1968]: seven of 25, of which 24 are looked at first.
TEST(SlopeBetween, EveryFourthMayStray) {
  for (std::size_t phase = 0; phase < 4; ++phase) {
    std::vector<CyclePoint> points = line_of(25);
    for (std::size_t i = phase; i < points.size(); i += 4) points[i].value += i % 8 < 4 ? 0.2 : -0.3;
    EXPECT_NEAR(slope_within(points), kLineSlope, kLineRounding * kLineSlope) << phase;
  }
}

TEST(SlopeBetween, PointsOutsideOfTheLevelsDoNotCount) {
  std::vector<CyclePoint> points = line_of(12);
  points[1].value = -5.0;
  points[10].value = 7.0;
  EXPECT_NEAR(slope_within(points), kLineSlope, kLineRounding * kLineSlope);
}

TEST(SlopeBetween, TwoPointsHaveOneAndOneHasNone) {
  EXPECT_NEAR(slope_within(line_of(2)), kLineSlope, kLineRounding * kLineSlope);
  EXPECT_TRUE(std::isnan(slope_within(line_of(1))));
  EXPECT_TRUE(std::isnan(slope_within({})));
}

TEST(SlopeBetween, PointsOfOneTimeHaveNone) {
  std::vector<CyclePoint> points = line_of(4);
  for (CyclePoint& point : points) point.time_s = 3.0;
  EXPECT_TRUE(std::isnan(slope_within(points)));
  points.front().time_s -= kLineScan_s;
  EXPECT_TRUE(std::isfinite(slope_within(points)));
  points = std::vector<CyclePoint>(4, line_of(1).front());
  EXPECT_TRUE(std::isnan(slope_within(points)));
}

// No straight line within five standard deviations: still a slope of the size of the rise.
TEST(SlopeBetween, ABentRiseHasASlopeOfItsOwn) {
  std::vector<CyclePoint> points = line_of(40);
  for (CyclePoint& point : points) point.value *= 0.5 + 4.0 * (point.time_s - 3.0);
  const double chord =
      (points.back().value - points.front().value) / (points.back().time_s - points.front().time_s);
  EXPECT_NEAR(slope_within(points), chord, 0.2 * chord);
}

// Points of many scans each tell a bend of 30 % from noise, so that most of them are off any line: the few
// that are not have no say, and the slope is the median of all slopes, which is that of the chord by
// symmetry.
TEST(SlopeBetween, OfABentRiseOfManyScansItIsTheMedian) {
  std::vector<CyclePoint> points = line_of(20);
  const double length_s = points.back().time_s - 3.0;
  for (CyclePoint& point : points) {
    const double part = (point.time_s - 3.0) / length_s;
    point.value = kLineSlope * length_s * (0.7 * part + 0.3 * part * part);
    point.count = 25.0;
  }
  // A difference quotient of two of n points is the chord's slope where their middle is the middle; medians
  // of n (n − 1)/2 of them are within one point of it: 0.6 of a slope over n points.
  EXPECT_NEAR(slope_within(points), kLineSlope, 0.6 / 20.0 * kLineSlope);
}

// Outside of the levels another line follows, close enough to the noise to be no stray.
TEST(SlopeBetween, PointsNearTheLevelsDoNotCountEither) {
  constexpr double kLargeNoise = 0.05;
  std::vector<CyclePoint> points = line_of(24);
  const double half = points[12].value;
  for (CyclePoint& point : points) point.value = std::min(point.value, half);
  EXPECT_NEAR(detect::slope_between(points, -1.0, std::nextafter(half, 0.0), kLargeNoise).value_or(0.0),
              kLineSlope, kLineRounding * kLineSlope);
}

// A point of z standard deviations counts with Huber's weight, 1.345/|z|: the last one of a line, 4 σ off,
// turns it by a third of what it would by least squares, (z σ)(t − t̄)/Σ(t − t̄)².
TEST(SlopeBetween, PointFarFromTheLineCountsLess) {
  constexpr std::size_t kCount = 41;
  std::vector<CyclePoint> points = line_of(kCount);
  points.back().value += 4.0 * kNoise;
  constexpr double kArm = 0.5 * (kCount - 1.0);
  constexpr double kSquares = kCount * (kCount * kCount - 1.0) / 12.0;
  const double least_squares = 4.0 * kNoise * kArm / kSquares / kLineScan_s;
  EXPECT_GT(slope_within(points) - kLineSlope, 0.25 * least_squares);
  EXPECT_LT(slope_within(points) - kLineSlope, 0.45 * least_squares);
}

constexpr double kVertex_s = 3.0123;
constexpr double kVertexValue = 0.35;
constexpr double kBend = -40.0;  // c″/2, 1/s²

double parabola(double time_s) { return kVertexValue + kBend * (time_s - kVertex_s) * (time_s - kVertex_s); }

/// Scans of the parabola about 3 s, in blocks.
std::vector<CyclePoint> parabola_in_blocks(int blocks, int scans_in_block) {
  std::vector<CyclePoint> points;
  int scan = -blocks * scans_in_block / 2;
  for (int i = 0; i < blocks; ++i) {
    CyclePoint point{0.0, 0.0, 0.0, static_cast<double>(scans_in_block), 3.0 + scan * kLineScan_s, 0.0};
    for (int k = 0; k < scans_in_block; ++k, ++scan) {
      const double time_s = 3.0 + scan * kLineScan_s;
      point.time_s += time_s / scans_in_block;
      point.value += parabola(time_s) / scans_in_block;
      point.last_s = time_s;
    }
    for (double time_s = point.first_s; time_s < point.last_s + 0.5 * kLineScan_s; time_s += kLineScan_s)
      point.spread_s2 += (time_s - point.time_s) * (time_s - point.time_s) / scans_in_block;
    points.push_back(point);
  }
  return points;
}

// The mean of a block lies c″/2 times its spread off the parabola, and is asked there.
TEST(ParabolaVertex, IsExactForScansAndForMeansOfScans) {
  for (const auto& [blocks, scans_in_block] : {std::pair{40, 1}, std::pair{10, 4}, std::pair{6, 7}}) {
    const auto vertex = detect::parabola_vertex(parabola_in_blocks(blocks, scans_in_block), 3.01, 0.05, 1.0);
    ASSERT_TRUE(vertex) << scans_in_block;
    EXPECT_NEAR(vertex->time_s, kVertex_s, 1e-10) << scans_in_block;
    EXPECT_NEAR(vertex->value, kVertexValue, 1e-12) << scans_in_block;
  }
}

TEST(ParabolaVertex, NoneWhereItIsNot) {
  const std::vector<CyclePoint> points = parabola_in_blocks(40, 1);
  EXPECT_FALSE(detect::parabola_vertex(points, 3.01, 0.05, -1.0)) << "a maximum is no minimum";
  EXPECT_FALSE(detect::parabola_vertex(points, 3.0, 0.0120, 1.0)) << "beyond the reach";
  EXPECT_TRUE(detect::parabola_vertex(points, 3.0, 0.0126, 1.0));
  EXPECT_FALSE(detect::parabola_vertex(std::span{points}.first(2), points[0].time_s, 1.0, 1.0));
}

TEST(TurningPointsOfASlip, MaximumAndMinimumHaveKBetweenThem) {
  // From rest at the maximum: half an oscillation later e^(−πγ/2ω) of the distance from K is left.
  const auto oscillator = model::Oscillator::from_omega(125.0, 0.05);
  const double left = std::exp(-0.05 * std::numbers::pi);
  EXPECT_NEAR(detect::K_of_turning_points(0.3 + 0.05, 0.3 - 0.05 * left, oscillator), 0.3, 1e-15);
}

// Forwards by the closed forms [15]–[18], backwards by slip_of_peak().
TEST(TurningPointsOfASlip, HeightOfThePeakGivesStaticLessKinetic) {
  constexpr double kD = 0.05;
  constexpr double kRate = 125.0;
  for (const double gamma_over_2omega : {0.0, 0.022, 0.2}) {
    const auto oscillator = model::Oscillator::from_omega(kRate, gamma_over_2omega);
    for (const double Q : {0.05, 0.5, 1.3, 3.0}) {
      const model::SlipWaveform slip{0.0, kD, Q * kRate * kD, oscillator};
      const double peak = slip.value(slip.peak_time_s());
      const detect::SlipOfPeak found = detect::slip_of_peak(peak, slip.r, oscillator);
      // The last step is below 1e-5 of it, and the next one about its square.
      EXPECT_NEAR(found.delta_mu, kD, 1e-8 * kD) << gamma_over_2omega << ", " << Q;
      EXPECT_NEAR(found.peak_time_s, slip.peak_time_s(), 1e-5 / kRate) << gamma_over_2omega << ", " << Q;
      const double ratio = -slip.rate(slip.fastest_slip_time_s()) / slip.r;
      EXPECT_NEAR(found.slip_speed_ratio, ratio, 1e-8 * ratio) << gamma_over_2omega << ", " << Q;
    }
  }
}

}  // namespace
}  // namespace stickslip::estimate
