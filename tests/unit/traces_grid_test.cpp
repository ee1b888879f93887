// The scan index of each row: from the times, and never against them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/traces/grid.hpp"

namespace stickslip::traces {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<double> times(std::size_t count, double rate_Hz, double digit_s) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    time.push_back(digit_s > 0.0 ? std::round(t / digit_s) * digit_s : t);
  }
  return time;
}

base::Result<Grid> grid(const std::vector<double>& time, GridOptions options = {}) {
  const base::LongColumn<double> column{time};
  return grid_of(RowView{column, 0.0, 1.0, false}, options,
                 [](std::size_t row) { return fmt::format("row {}", row); });
}

std::vector<std::size_t> runs(const std::vector<double>& time) {
  const base::LongColumn<double> column{time};
  return runs_in(RowView{column, 0.0, 1.0, false});
}

std::string refusal(const std::vector<double>& time, const GridOptions& options = {}) {
  const auto found = grid(time, options);
  return found ? fmt::format("no refusal: {} Hz", found->rate_Hz) : found.error().message;
}

TEST(TraceGrid, MissingRowsAreJumpsOfTheIndex) {
  auto time = times(100, 50.0, 0.0);
  time.erase(time.begin() + 10, time.begin() + 15);
  const auto found = grid(time);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->index[9], 9);
  EXPECT_EQ(found->index[10], 15);
  EXPECT_NEAR(found->rate_Hz, 50.0, 1e-9);
}

TEST(TraceGrid, TimesRoundedToWholeMillisecondsGiveTheRate) {
  GridOptions options;
  options.digit_s = 0.001;
  const auto found = grid(times(2800, 350.0, 0.001), options);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rate_Hz, 350.0, 0.01);
  EXPECT_EQ(found->index.back(), 2799);
}

// At 1 kHz in whole milliseconds: equal intervals without a gap do not fit.
TEST(TraceGrid, MissingRowBeforeTheLastOneOfWholeMillisecondsIsAJump) {
  GridOptions options;
  options.digit_s = 0.001;
  for (const std::size_t count : {37U, 201U}) {
    auto time = times(count, 1000.0, 0.001);
    time.erase(time.end() - 2);
    const auto found = grid(time, options);
    ASSERT_TRUE(found) << count << ": " << found.error().message;
    EXPECT_NEAR(found->rate_Hz, 1000.0, 1e-6);
    EXPECT_EQ(found->index[count - 3], static_cast<std::int64_t>(count) - 3);
    EXPECT_EQ(found->index.back(), static_cast<std::int64_t>(count) - 1);
  }
}

TEST(TraceGrid, JitterBeyondTheLimitIsRefusedWithRowAndRemedy) {
  auto time = times(100, 50.0, 0.0);
  time[40] += 0.11 / 50.0;
  EXPECT_THAT(refusal(time), testing::AllOf(HasSubstr("row 40"), HasSubstr("give --resample")));
  GridOptions options;
  options.resample = true;
  const auto found = grid(time, options);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->uniform);
  time[40] -= 0.02 / 50.0;
  EXPECT_TRUE(grid(time));
}

TEST(TraceGrid, DoubledRowsAreLeftOutOnRequestAlone) {
  auto time = times(100, 50.0, 0.0);
  time.insert(time.begin() + 5, time[5]);
  EXPECT_THAT(refusal(time), testing::AllOf(HasSubstr("row 6"), HasSubstr("give --skip-doubled")));
  GridOptions options;
  options.skip_doubled = true;
  const auto found = grid(time, options);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->doubled[6]);
  EXPECT_EQ(found->index[7], 6);
}

TEST(TraceGrid, TimesThatDoNotRiseAreRefused) {
  EXPECT_THAT(refusal({1.0, 1.0, 1.0}), HasSubstr("does not advance"));
  EXPECT_THAT(refusal({3.0, 2.0, 1.0}), HasSubstr("give --reverse"));
  auto time = times(100, 50.0, 0.0);
  time[60] = time[58];
  EXPECT_THAT(refusal(time), HasSubstr("row 60: time goes back"));
}

TEST(TraceGrid, StatedRateIsComparedWithTheTimes) {
  GridOptions options;
  options.rate_Hz = 300.0;
  EXPECT_THAT(refusal(times(100, 350.0, 0.0), options), HasSubstr("runs at 350 Hz, --rate says 300 Hz"));
  options.rate_Hz = 350.0 * 1000.0;
  options.time_unit = "s";
  EXPECT_THAT(refusal(times(100, 350.0, 0.0), options), HasSubstr("give --time-unit ms"));
}

TEST(TraceGrid, CoarseTimesCannotCheckARate) {
  GridOptions options;
  options.digit_s = 1.0;
  const auto time = times(1000, 340.0, 1.0);
  EXPECT_THAT(refusal(time, options), HasSubstr("too coarse"));
  options.rate_Hz = 350.0;
  const auto found = grid(time, options);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->rate_checked);
}

// More is lost than two ticks of a clock that stands for two rows or more.
TEST(TraceGrid, CoarseClockShowsMissingRows) {
  for (const double digit_s : {0.01, 0.1, 0.25}) {
    auto time = times(1600, 200.0, 0.0);
    for (double& t : time) t = digit_s * std::floor((t + 1e-9) / digit_s);
    time.erase(time.begin() + 700, time.begin() + 700 + std::llround(500.0 * digit_s) + 45);
    GridOptions options;
    options.digit_s = digit_s;
    options.rate_Hz = 200.0;
    const auto found = grid(time, options);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->index[699], 699);
    EXPECT_NEAR(static_cast<double>(found->index.back()), 1599.0, 1.0) << digit_s;
  }
  // Ticks of a row more or less.
  GridOptions options;
  options.digit_s = 0.1;
  options.rate_Hz = 340.0;
  const auto found = grid(times(1000, 340.0, 0.1), options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->index.back(), 999);
}

TEST(TraceGrid, CoarseClockRefusesAnotherRate) {
  auto time = times(1600, 200.0, 0.0);
  for (double& t : time) t = std::floor(t + 1e-9);
  GridOptions options;
  options.digit_s = 1.0;
  for (const double rate_Hz : {100.0, 2000.0}) {
    options.rate_Hz = rate_Hz;
    EXPECT_THAT(refusal(time, options), HasSubstr("--rate \"200 Hz\" to go by the column"));
  }
  options.rate_Hz = 190.0;  // 6 s ± 1 s.
  EXPECT_TRUE(grid(time, options));
}

// Three significant digits: 0.01 s below 10 s, 0.1 s from there on. Nothing is missing.
TEST(TraceGrid, CoarseClockWhoseResolutionChangesShowsNoGaps) {
  auto time = times(2000, 100.0, 0.0);
  for (double& t : time) {
    if (t >= 10.0) t = std::floor(t * 10.0 + 1e-9) / 10.0;
  }
  GridOptions options;
  options.digit_s = 0.01;
  options.rate_Hz = 100.0;
  const auto found = grid(time, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->index.back(), 1999);
}

// Rows arrive in bursts of 8 ms, now and then late; the clock makes it up.
TEST(TraceGrid, CoarseClockThatStallsShowsNoGaps) {
  std::vector<double> time;
  for (int i = 0; i < 4000; ++i) {
    const int burst = i / 8;
    time.push_back(0.008 * (burst % 100 >= 90 ? burst / 100 * 100 + 100 : burst));
  }
  GridOptions options;
  options.digit_s = 0.001;
  options.rate_Hz = 1000.0;
  const auto found = grid(time, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->index.back(), 3999);
}

TEST(TraceGrid, NoRowsAreNoCount) {
  const base::LongColumn<double> none;
  EXPECT_FALSE(is_count(RowView{none, 0.0, 1.0, false}));
}

TEST(TraceGrid, CountersContinueWhereTheyStartAgain) {
  base::LongColumn<double> count;
  for (int i = 0; i < 2000; ++i) {
    if (i != 1000) count.push_back(i % 256);
  }
  EXPECT_TRUE(is_count(RowView{count, 0.0, 1.0, false}));
  const Continued whole = continued(count, 0.0, true, {});
  EXPECT_EQ(whole.column[999], 999.0);
  EXPECT_EQ(whole.column.back(), 1999.0);
  EXPECT_EQ(whole.starts, 7U);
  EXPECT_EQ(whole.end, 256.0);
  const Continued as_it_was = continued(count, 0.0, false, {});
  EXPECT_EQ(as_it_was.column.back(), 1999 % 256);
  EXPECT_EQ(as_it_was.starts, 0U);
  // Two runs of a counter far from any power of two.
  base::LongColumn<double> twice;
  for (int i = 0; i < 2000; ++i) twice.push_back(i % 1000);
  EXPECT_EQ(continued(twice, 0.0, true, {}).column.back(), 999.0);
  base::LongColumn<double> still;
  still.assign(10, 3.0);
  EXPECT_FALSE(is_count(RowView{still, 0.0, 1.0, false}));
}

// At 100 Hz printed to 0.01 s, rows that are lost here and there look like a lower rate.
TEST(TraceGrid, CoarseTimesWithLostRowsNeedTheRate) {
  auto time = times(1000, 100.0, 0.01);
  for (const std::ptrdiff_t lost : {900, 210, 207, 203, 202, 200, 150, 148, 147, 140})
    time.erase(time.begin() + lost);
  GridOptions options;
  options.digit_s = 0.01;
  EXPECT_THAT(refusal(time, options), HasSubstr("give --rate HZ"));
  options.rate_Hz = 100.0;
  const auto found = grid(time, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->index.back(), 999);
  EXPECT_FALSE(found->rate_checked);
}

TEST(TraceGrid, ClockThatStartsAgainBeginsARun) {
  EXPECT_THAT(runs({0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0}), ElementsAre(0U, 4U));
  EXPECT_THAT(runs({3.0, 2.0, 1.0, 0.0}), ElementsAre(0U));
  EXPECT_THAT(runs({0.0, 1.0, 2.0, 1.9, 3.0}), ElementsAre(0U));
}

}  // namespace
}  // namespace stickslip::traces
