#include "core/analysis/live_estimates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace stickslip::detect {
namespace {

/// Five slips, 0.2 s apart, of which the live side saw all but one.
class LiveEstimates : public testing::Test {
 protected:
  static constexpr double kRate_Hz = 100.0;
  static constexpr double kPeriod_scans = 20.0;
  static constexpr std::size_t kSlips = 5;
  static constexpr std::size_t kUnseen = 2;

  LiveEstimates() {
    for (std::size_t scan = 0; scan < 150; ++scan) {
      trace_.time_s.push_back(static_cast<double>(scan) / kRate_Hz);
      trace_.value.push_back(0.3);
      trace_.usable.push_back(1);
    }
    for (std::size_t i = 0; i < kSlips; ++i) {
      Fall fall;
      fall.peak_at = 20.0 + kPeriod_scans * static_cast<double>(i);
      fall.trough_at = fall.peak_at + 6.0;
      fall.peak = 0.36;
      fall.trough = 0.26 + 0.01 * static_cast<double>(i);
      slips_.push_back(fall);
      if (i == kUnseen) continue;
      LiveCycle seen;
      Cycle& cycle = seen.cycle;
      cycle.number = static_cast<std::int64_t>(live_.size());
      cycle.peak_time_s = fall.peak_at / kRate_Hz + 0.004;  // By its own interpolation.
      cycle.peak = 0.37;
      cycle.delta_mu = 0.05 + 0.001 * static_cast<double>(i);
      cycle.trough = fall.trough;
      seen.evidence = cycle.live_capture_evidence = 10.0 + static_cast<double>(i);
      cycle.flags = kCycleCaptured | kCycleHasSpike | (i == 0 ? kCycleIsFirst : 0);
      seen.S = 0.36;
      seen.K = 0.31 - 0.001 * static_cast<double>(i);
      live_.push_back(seen);
    }
  }

  [[nodiscard]] analysis::TestEstimates estimates() const {
    return analysis::estimates_from_live(trace_, slips_, live_, {.reason = "no fit"});
  }

  estimate::Trace trace_;
  base::LongColumn<Fall> slips_;
  base::LongColumn<LiveCycle> live_;
};

TEST_F(LiveEstimates, GiveEachSlipWhatWasSeenOfIt) {
  const analysis::TestEstimates found = estimates();
  const base::LongColumn<Cycle>& rows = found.cycles;
  ASSERT_EQ(rows.size(), kSlips);
  for (std::size_t i = 0; i < kSlips; ++i) {
    EXPECT_EQ(rows[i].number, static_cast<std::int64_t>(i));
    EXPECT_EQ((rows[i].flags & kCycleIsFirst) != 0, i == 0);
    // Spikes, gaps and saturation are looked up in the whole test.
    EXPECT_EQ(rows[i].flags & kCycleHasSpike, 0);
    if (i == kUnseen) continue;
    EXPECT_EQ(rows[i].peak, 0.37);
    EXPECT_DOUBLE_EQ(rows[i].delta_mu, 0.05 + 0.001 * static_cast<double>(i));
    EXPECT_DOUBLE_EQ(rows[i].force_drop, rows[i].peak - rows[i].trough);
    EXPECT_EQ((rows[i].flags & kCycleCaptured) != 0, i + 1 < kSlips) << "in the last one the pull ended";
  }
  EXPECT_EQ(found.captured, 3);
}

TEST_F(LiveEstimates, TellOfAnUnseenSlipWhatItsFallTells) {
  const analysis::TestEstimates found = estimates();
  const Cycle row = found.cycles[kUnseen];
  EXPECT_DOUBLE_EQ(row.peak_time_s, 0.6);
  EXPECT_DOUBLE_EQ(row.force_drop, 0.36 - 0.28);
  EXPECT_TRUE(std::isnan(row.delta_mu));
  EXPECT_TRUE(std::isnan(row.capture_evidence));
  EXPECT_EQ(found.log_likelihood_ratios[kUnseen], 0.0) << "it says nothing";
}

TEST_F(LiveEstimates, HavePeriodsFromPeakToPeakAndNoneOverABreak) {
  trace_.breaks.push_back(50);  // Between the second slip and the third.
  const analysis::TestEstimates found = estimates();
  const base::LongColumn<Cycle>& rows = found.cycles;
  EXPECT_DOUBLE_EQ(rows[0].period_s, rows[1].peak_time_s - rows[0].peak_time_s);
  EXPECT_TRUE(std::isnan(rows[1].period_s));
  EXPECT_EQ(rows[1].peak, 0.37) << "what was seen of it is found without its period";
  EXPECT_TRUE(std::isnan(rows[4].period_s));
  EXPECT_EQ(rows[4].live_capture_evidence, 14.0) << "its own, not that of a slip before it";
  EXPECT_TRUE(std::isnan(rows[4].capture_evidence));
}

// The next fall behind a gap says nothing of how the slip before it ended, and nobody saw how that behind it
// began.
TEST_F(LiveEstimates, DoNotSayHowASlipBesideAGapEnded) {
  live_[0].cycle.flags |= kCycleHasGap;
  const analysis::TestEstimates found = estimates();
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_EQ(found.log_likelihood_ratios[i], 0.0) << i;
    const Cycle row = found.cycles[i];
    EXPECT_EQ(row.flags & kCycleCaptured, 0);
    EXPECT_TRUE(std::isnan(row.capture_evidence));
    EXPECT_EQ(row.live_capture_evidence, 10.0 + static_cast<double>(i)) << "as it was";
  }
  EXPECT_EQ(found.log_likelihood_ratios[3], 13.0);
}

TEST_F(LiveEstimates, TakeMeansOverTheSlipsOfTheWholeTest) {
  base::LongColumn<LiveCycle> live;
  for (std::size_t i = 0; i < live_.size(); ++i) {
    live.push_back(live_[i]);
    if (i != 1) continue;
    LiveCycle none = live_[i];  // Between two slips the live side took something for one more.
    none.cycle.peak_time_s = 0.47;
    none.K = 0.2;
    live.push_back(none);
  }
  live_ = std::move(live);
  // The first does not count if there are others.
  EXPECT_DOUBLE_EQ(*estimates().results.mu_k.value, 0.31 - 0.008 / 3.0);
}

TEST_F(LiveEstimates, AreThereWithoutAnythingSeen) {
  live_.clear();
  const analysis::TestEstimates found = estimates();
  EXPECT_EQ(found.cycles.size(), kSlips);
  EXPECT_EQ(found.captured, 0);
  EXPECT_FALSE(found.results.delta_mu.value);
  EXPECT_FALSE(found.results.delta_mu.reason.empty());
}

TEST_F(LiveEstimates, HaveAnAmplitudeAndForTheRestAReason) {
  const analysis::TestEstimates found = estimates();
  // Half the mean drop, 0.10 … 0.06.
  EXPECT_DOUBLE_EQ(*found.results.amplitude.value, 0.04);
  EXPECT_EQ(found.results.omega.reason, "no fit");
  EXPECT_EQ(found.results.delta_mu_combined.reason, "no fit");
  EXPECT_EQ(found.log_likelihood_ratios.size(), kSlips - 1);
  EXPECT_FALSE(found.tester);
}

TEST_F(LiveEstimates, NoCycleStandsForTwoSlips) {
  analysis::LiveCycles seen{trace_, live_};
  EXPECT_TRUE(seen.next_at(slips_[0], 0.2));
  EXPECT_TRUE(seen.next_at(slips_[1], 0.2));
  EXPECT_FALSE(seen.next_at(slips_[kUnseen], 0.2));
  EXPECT_EQ(seen.next_at(slips_[3], 0.2)->cycle.number, 2);
  EXPECT_EQ(seen.next_at(slips_[4], std::numeric_limits<double>::quiet_NaN())->cycle.number, 3);
  EXPECT_FALSE(seen.next_at(slips_[4], std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace stickslip::detect
