#include "core/analysis/slip_list.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stickslip::detect {
namespace {

constexpr double kPeriod = 20.0;  // scans
constexpr double kPeak = 0.38;
constexpr double kTrough = 0.24;

Fall fall(double peak_at, double peak, double trough, double rise_from) {
  Fall fall;
  fall.peak_at = peak_at;
  fall.trough_at = peak_at + kPeriod / 2.0;
  fall.peak = peak;
  fall.trough = trough;
  fall.duration = 6.0;
  fall.rise_duration = kPeriod / 2.0;
  fall.rise_from = rise_from;
  fall.robust_drop = peak - trough;
  return fall;
}

/// Regular slips from scan 100 on, loaded from `rest`.
std::vector<Fall> slips(int count, double rest = 0.0) {
  std::vector<Fall> all;
  all.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    all.push_back(fall(100.0 + kPeriod * i, kPeak, kTrough, i == 0 ? rest : kTrough));
  }
  return all;
}

TEST(SlipList, RegularSlipsStay) {
  for (const int count : {0, 1, 2, 3, 40}) {
    for (const double rest : {0.0, kTrough}) {
      const base::LongColumn<Fall> kept = analysis::kept_slips(slips(count, rest));
      EXPECT_EQ(kept.size(), static_cast<std::size_t>(count)) << rest;
    }
  }
}

TEST(SlipList, SlipsOfAnySizeInAnyOrderStay) {
  // Paper scatters by a half, and a trace may begin in the middle of a test.
  std::vector<Fall> falls;
  for (int i = 0; i < 30; ++i) {
    const double size = 0.5 + 0.05 * ((7 * i) % 21);
    falls.push_back(fall(kPeriod * (1 + i), 0.31 + 0.07 * size, 0.31 - 0.07 * size, i == 0 ? 0.25 : 0.31));
  }
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), falls.size());
}

TEST(SlipList, TwoSpikesBeforeTheLoadingAreNoSlip) {
  std::vector<Fall> falls = slips(10);
  falls.front().rise_from = -0.01;
  falls.insert(falls.begin(), fall(30.0, 0.05, -0.01, 0.0));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), 10U);
  EXPECT_EQ(kept.front().peak_at, 100.0);
}

TEST(SlipList, SpikesFarBelowRestBeforeTheLoadingAreNoSlip) {
  std::vector<Fall> falls = slips(10);
  falls.front().rise_from = -0.15;
  falls.insert(falls.begin(), fall(30.0, 0.003, -0.15, 0.0));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  ASSERT_EQ(kept.size(), 10U);
  EXPECT_EQ(kept[0].peak_at, 100.0);
}

TEST(SlipList, UnloadingIsNoSlip) {
  std::vector<Fall> falls = slips(10);
  falls.push_back(fall(900.0, 0.33, 0.001, kTrough));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), 10U);
}

TEST(SlipList, SlipsThatEndAtRestStay) {
  // A coupling that hangs slack after each slip: S of twice K and more.
  std::vector<Fall> falls;
  falls.reserve(10);
  for (int i = 0; i < 10; ++i) falls.push_back(fall(100.0 + 40.0 * i, 0.5, 0.0, 0.0));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), 10U);
}

TEST(SlipList, SpikesInTheHoldAfterThePullAreNoSlip) {
  // The force stays where the belt stopped; sticking to a moving belt it would have climbed by 0.14 in half a
  // period.
  std::vector<Fall> falls = slips(10);
  const double last = falls.back().peak_at;
  falls.push_back(fall(last + 10.0 * kPeriod, 0.40, 0.27, 0.30));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), 10U);
}

TEST(SlipList, StepFromScanToScanIsNoSlip) {
  // The others take six scans: less than 0.4 · 6 − 1 = 1.4 is too quick.
  std::vector<Fall> falls = slips(10);
  Fall step = fall(falls.back().peak_at + 2.0 * kPeriod, 0.5, 0.3, kTrough);
  for (const double duration : {1.0, 2.0}) {
    step.duration = duration;
    std::vector<Fall> with = falls;
    with.push_back(step);
    EXPECT_EQ(analysis::kept_slips(with).size(), duration < 1.4 ? 10U : 11U);
  }
}

TEST(SlipList, LastSlipAfterALongStickStays) {
  std::vector<Fall> falls;
  falls.reserve(10);
  for (int i = 0; i < 10; ++i)
    falls.push_back(fall(100.0 + 10.0 * kPeriod * i, kPeak, kTrough, i == 0 ? 0.0 : kTrough));
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  EXPECT_EQ(kept.size(), falls.size());
}

TEST(SlipList, SlipThatSpikesHaveSplitIsOne) {
  std::vector<Fall> falls = slips(10);
  Fall second = falls[4];
  falls[4].trough_at = falls[4].peak_at + 3.0;
  falls[4].trough = 0.33;
  second.peak_at = falls[4].trough_at + 2.0;
  second.peak = 0.36;
  falls.insert(falls.begin() + 5, second);
  const base::LongColumn<Fall> kept = analysis::kept_slips(falls);
  ASSERT_EQ(kept.size(), 10U);
  EXPECT_EQ(kept[4].peak, kPeak);
  EXPECT_EQ(kept[4].trough, kTrough);
  EXPECT_EQ(kept[4].trough_at, kept[4].peak_at + kPeriod / 2.0);
}

}  // namespace
}  // namespace stickslip::detect
