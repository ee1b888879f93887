// The rise before a slip.

#include "core/detect/rise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stickslip::estimate {
namespace {

constexpr double kScan_s = 0.01;
constexpr double kSlope = 0.5;
constexpr double kScanSigma = 0.001;
/// Rest, a rounded begin, and a line from kLine_s on to the peak.
constexpr double kLine_s = 0.6;
constexpr double kPeak_s = 1.4;

double course(double time_s) {
  if (time_s >= kLine_s) return kSlope * (time_s - 0.5 * kLine_s);
  const double part = std::max(time_s, 0.0) / kLine_s;
  return 0.5 * kSlope * kLine_s * part * part;  // With the line's slope at its end.
}

std::vector<CyclePoint> scans() {
  std::vector<CyclePoint> points;
  for (int k = -20; k <= 140; ++k) {
    const double time_s = k * kScan_s;
    points.push_back({time_s, course(time_s), 0.0, 1.0, time_s, time_s});
  }
  return points;
}

const detect::Rise kRise{0.0, course(kPeak_s), -20.0 * kScan_s, kPeak_s};

TEST(Rise, LineBeginsBehindRestAndRoundedBegin) {
  const std::vector<CyclePoint> points = scans();
  const double from_s = kRise.line_from_s(points, kRise.begin_s);
  EXPECT_GT(from_s, kLine_s - kScan_s);
  EXPECT_LT(from_s, 0.5 * (kLine_s + kPeak_s));
  // What is given is the earliest.
  EXPECT_EQ(kRise.line_from_s(points, 1.3), 1.3);
  EXPECT_EQ(kRise.line_from_s({}, 0.4), 0.4);
}

TEST(Rise, SlopeIsThatOfTheLine) {
  EXPECT_NEAR(kRise.slope(scans(), kRise.begin_s, kScanSigma), kSlope, 1e-9);
  // A stray scan bends nothing.
  std::vector<CyclePoint> stray = scans();
  stray[110].value += 0.2;
  EXPECT_NEAR(kRise.slope(stray, kRise.begin_s, kScanSigma), kSlope, 1e-9);
}

// All that is there is below the line: nothing of it is used.
TEST(Rise, NoLineWhereNoScanIsOnIt) {
  std::vector<CyclePoint> points = scans();
  std::erase_if(points, [](const CyclePoint& point) { return point.time_s > 0.3; });
  EXPECT_EQ(kRise.line_from_s(points, kRise.begin_s), kPeak_s);
}

// A fast loading: so few scans between 0.3 and 0.7 of the rise that those from 0.1 to 0.8 are asked. Outside
// of these the rise is bent here.
TEST(Rise, FewScansOfAFastLoadingAreAskedForMore) {
  const double peak = 1.0;
  const detect::Rise rise{0.0, peak, 0.0, 0.1};
  std::vector<CyclePoint> points;
  for (int k = 0; k <= 10; ++k) {
    const double time_s = k * kScan_s;
    double value = 10.0 * time_s;
    if (value < 0.05 || value > 0.85) value += 0.03;
    if (k == 5) value += 0.2;  // Of the five scans in the middle one is a stray.
    points.push_back({time_s, value, 0.0, 1.0, time_s, time_s});
  }
  EXPECT_NEAR(rise.slope(points, 0.0, kScanSigma), 10.0, 1e-9);
}

/// A straight rise by 1 within 0.1 s, in so many scans, whose slope is another below and above two levels: by
/// little against a large noise, so that no scan is a stray.
constexpr double kLargeSigma = 0.1;
const detect::Rise kFastRise{0.0, 1.0, 0.0, 0.1};
std::vector<CyclePoint> bent_outside_of(double low, double high, int scan_count) {
  std::vector<CyclePoint> points;
  for (int k = 0; k <= scan_count; ++k) {
    const double time_s = 0.1 * k / scan_count;
    const double line = 10.0 * time_s;
    const double value = line < low    ? low - 0.8 * (low - line)
                         : line > high ? high + 0.8 * (line - high)
                                       : line;
    points.push_back({time_s, value, 0.0, 1.0, time_s, time_s});
  }
  return points;
}
double slope_of(const std::vector<CyclePoint>& points) { return kFastRise.slope(points, 0.0, kLargeSigma); }

TEST(Rise, SlopeIsThatOfItsMiddle) {
  EXPECT_NEAR(slope_of(bent_outside_of(0.3, 0.7, 100)), 10.0, 1e-9);
  EXPECT_LT(slope_of(bent_outside_of(0.32, 0.7, 100)), 10.0 - 1e-3);
  EXPECT_LT(slope_of(bent_outside_of(0.3, 0.68, 100)), 10.0 - 1e-3);
}

TEST(Rise, SlopeOfFewScansIsThatOfMoreOfIt) {
  EXPECT_NEAR(slope_of(bent_outside_of(0.1, 0.8, 10)), 10.0, 1e-9);
  EXPECT_LT(slope_of(bent_outside_of(0.2001, 0.8, 10)), 10.0 - 1e-3);
  EXPECT_LT(slope_of(bent_outside_of(0.1, 0.6999, 10)), 10.0 - 1e-3);
}

// Scans at 1/19, 2/19 … of the rise: eight of them, 6/19 to 13/19, lie in its middle. At 1/17, 2/17 … six do.
TEST(Rise, EightScansOfItsMiddleAreEnough) {
  EXPECT_NEAR(slope_of(bent_outside_of(0.3, 0.7, 19)), 10.0, 1e-9);
  EXPECT_LT(slope_of(bent_outside_of(0.3, 0.7, 17)), 10.0 - 1e-3);
}

// The fall before the rise passes the same levels; with this noise its points would be no outliers of a line.
TEST(Rise, SlopeIsOfScansBehindTheTurningPoint) {
  std::vector<CyclePoint> points;
  for (int k = 30; k > 0; --k) {
    const double time_s = -0.1 / 30.0 * k;
    points.push_back({time_s, -10.0 * time_s, 0.0, 1.0, time_s, time_s});
  }
  const std::vector<CyclePoint> rise = bent_outside_of(0.0, 1.0, 100);
  points.insert(points.end(), rise.begin(), rise.end());
  EXPECT_NEAR(kFastRise.slope(points, -1.0, 10.0 * kLargeSigma), 10.0, 1e-9);
}

TEST(Rise, SlopeOfTheWholeWhereScansTellNothing) {
  EXPECT_NEAR(kRise.slope({}, 0.0, kScanSigma), course(kPeak_s) / 1.6, 1e-12);
}

}  // namespace
}  // namespace stickslip::estimate
