#include "core/detect/turning_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

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

}  // namespace
}  // namespace stickslip::estimate
