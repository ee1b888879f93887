#include "core/estimate/cycle_buffer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/allocation_count.hpp"

namespace stickslip::estimate {
namespace {

constexpr double kRate_Hz = 100'000.0;

TEST(CycleBuffer, KeepsScansAsTheyAreWhileThereIsRoom) {
  CycleBuffer buffer;
  for (std::size_t k = 0; k < CycleBuffer::kMostPoints; ++k)
    buffer.add(static_cast<double>(k), 2.0 * static_cast<double>(k));
  ASSERT_EQ(buffer.points().size(), CycleBuffer::kMostPoints);
  for (std::size_t k = 0; k < CycleBuffer::kMostPoints; ++k) {
    EXPECT_EQ(buffer.points()[k].time_s, static_cast<double>(k));
    EXPECT_EQ(buffer.points()[k].value, 2.0 * static_cast<double>(k));
    EXPECT_EQ(buffer.points()[k].count, 1.0);
    EXPECT_EQ(buffer.points()[k].spread_s2, 0.0);
  }
}

TEST(CycleBuffer, NeverHoldsMoreAndLosesNoScanHoweverManyCome) {
  CycleBuffer buffer;
  const std::uint64_t before = test::allocation_count();
  constexpr int kScans = 2'000'000;  // 20 s at 100 kHz.
  for (int k = 0; k < kScans; ++k) {
    buffer.add(k / kRate_Hz, 0.3);
    ASSERT_LE(buffer.points().size(), CycleBuffer::kMostPoints);
  }
  EXPECT_EQ(test::allocation_count(), before);
  double count = 0.0;
  double last_s = -1.0;
  for (const CyclePoint& point : buffer.points()) {
    count += point.count;
    EXPECT_GT(point.first_s, last_s);
    last_s = point.last_s;
  }
  EXPECT_EQ(count, kScans);
  EXPECT_EQ(last_s, (kScans - 1) / kRate_Hz);
}

TEST(CycleBuffer, BlocksAreNoLongerThanAnEighthOfTheirAge) {
  CycleBuffer buffer;
  constexpr int kScans = 200'000;  // A cycle of 2 s at 100 kHz.
  for (int k = 0; k < kScans; ++k) buffer.add(k / kRate_Hz, 0.0);
  const double now_s = (kScans - 1) / kRate_Hz;
  for (const CyclePoint& point : buffer.points()) {
    EXPECT_LE((point.last_s - point.first_s) * 8.0, now_s - point.last_s) << point.first_s;
  }
}

TEST(CycleBuffer, KeepsASlipUnderWayFineForAsLongAsItIsTold) {
  CycleBuffer buffer;
  constexpr double kFrom_s = 0.1;
  constexpr double kTo_s = 0.15;
  constexpr double kLongest_s = 0.0015;
  for (int k = 0; k < 400'000; ++k) {
    if (k == 0) buffer.keep_fine(kFrom_s, kTo_s, kLongest_s);
    buffer.add(k / kRate_Hz, 0.0);
  }
  int inside = 0;
  for (const CyclePoint& point : buffer.points()) {
    if (point.first_s > kFrom_s && point.last_s < kTo_s) {
      ++inside;
      EXPECT_LE(point.last_s - point.first_s, kLongest_s);
    }
  }
  EXPECT_GE(inside, 33);  // 50 ms by 1.5 ms at the most
}

TEST(CycleBuffer, GivesUpFinenessWhereThereIsNoRoomForIt) {
  CycleBuffer buffer;
  buffer.keep_fine(0.0, 1e9, 1.0 / kRate_Hz);
  for (int k = 0; k < 10'000; ++k) {
    buffer.add(k / kRate_Hz, 0.0);
    ASSERT_LE(buffer.points().size(), CycleBuffer::kMostPoints);
  }
  double count = 0.0;
  for (const CyclePoint& point : buffer.points()) count += point.count;
  EXPECT_EQ(count, 10'000);
}

// A line's mean lies on the line; a parabola's is above it by half the second derivative times the variance.
TEST(CycleBuffer, MeansOfAParabolaAreItsValueAndTheCurvatureTerm) {
  CycleBuffer buffer;
  const auto value = [](double t) { return 0.3 + 0.5 * t - 40.0 * t * t; };
  for (int k = 0; k < 100'000; ++k) buffer.add(k / kRate_Hz, value(k / kRate_Hz));
  double longest = 0.0;
  for (const CyclePoint& point : buffer.points()) {
    longest = std::max(longest, point.count);
    // Rounding of the running means: a part ε for each joining, of values up to 40.
    EXPECT_NEAR(point.value, value(point.time_s) - 40.0 * point.spread_s2, 1e-11);
  }
  EXPECT_GT(longest, 1000.0);  // else nothing was tried
}

// The bound that the header gives: block of a tenth of an oscillation, h⁴ω⁴/1920 = 8e-5.
TEST(CycleBuffer, MeansOfAnOscillationAreWithinTheStatedBound) {
  constexpr int kBlock = 500;
  const double omega = 2.0 * std::numbers::pi * 20.0;  // 5000 scans a period
  double worst = 0.0;
  for (int phase = 0; phase < 10; ++phase) {
    CyclePoint mean{};
    for (int k = 0; k < kBlock; ++k) {
      const double t = (phase * kBlock + k) / kRate_Hz;
      mean.time_s += t / kBlock;
      mean.value += std::cos(omega * t) / kBlock;
    }
    const double spread = (kBlock * kBlock - 1.0) / 12.0 / (kRate_Hz * kRate_Hz);
    const double at = std::cos(omega * mean.time_s);
    worst = std::max(worst, std::abs(mean.value - at + 0.5 * omega * omega * spread * at));
  }
  EXPECT_LE(worst, std::pow(omega * kBlock / kRate_Hz, 4) / 1920.0);
}

TEST(CycleBuffer, ForgetsWhatEndedBefore) {
  CycleBuffer buffer;
  for (int k = 0; k < 100; ++k) buffer.add(k, 0.0);
  buffer.forget_before(40.0);
  EXPECT_EQ(buffer.points().size(), 60U);
  EXPECT_EQ(buffer.points().front().time_s, 40.0);
  EXPECT_EQ(buffer.since(90.0).size(), 10U);
  EXPECT_EQ(between(buffer.points(), 50.0, 60.0).size(), 10U);
  EXPECT_TRUE(between(buffer.points(), 200.0, 300.0).empty());
}

}  // namespace
}  // namespace stickslip::estimate
