#include "core/daq/gap.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>
#include <utility>

namespace stickslip::test {
namespace {

using daq::GapCause;
using daq::GapTracker;
using daq::ScanBlock;

ScanBlock block_at(daq::ScanIndex first, std::uint32_t count) {
  ScanBlock block;
  block.first = first;
  block.count = count;
  return block;
}

TEST(GapTracker, FirstBlockHasNoGapWhereverItBegins) {
  GapTracker tracker;
  EXPECT_FALSE(tracker.observe(block_at(1'000'000, 3)));
}

TEST(GapTracker, ConsecutiveBlocksHaveNone) {
  GapTracker tracker;
  EXPECT_FALSE(tracker.observe(block_at(0, 3)));
  EXPECT_FALSE(tracker.observe(block_at(3, 64)));
  EXPECT_FALSE(tracker.observe(block_at(67, 1)));
}

TEST(GapTracker, JumpIsHalfOpenBetweenTheBlocks) {
  GapTracker tracker;
  EXPECT_FALSE(tracker.observe(block_at(10, 5)));
  const auto gap = tracker.observe(block_at(16, 2), GapCause::kOverrun);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->first, 15);
  EXPECT_EQ(gap->count, 1);
  EXPECT_EQ(gap->cause, GapCause::kOverrun);
  EXPECT_FALSE(tracker.observe(block_at(18, 1)));
}

TEST(GapTracker, EachJumpIsReportedOnItsOwn) {
  GapTracker tracker;
  EXPECT_FALSE(tracker.observe(block_at(0, 1)));
  EXPECT_EQ(tracker.observe(block_at(5, 1))->count, 4);
  EXPECT_EQ(tracker.observe(block_at(9, 1))->count, 3);
}

// A board that halted does not know how long; a ring that dropped blocks does.
TEST(GapTracker, CountIsAnEstimateExactlyWhereTheBoardHadHalted) {
  for (const auto& [cause, estimated] : {std::pair{GapCause::kOverrun, true},
                                         {GapCause::kBoardMissing, true},
                                         {GapCause::kRingFull, false},
                                         {GapCause::kMissingScans, false},
                                         {GapCause::kUnknown, false}}) {
    GapTracker tracker;
    EXPECT_FALSE(tracker.observe(block_at(0, 1)));
    EXPECT_EQ(tracker.observe(block_at(2, 1), cause)->estimated, estimated) << name(cause);
  }
}

// Two years at 100 kHz: far beyond 32 bits, where a narrower index would wrap.
TEST(GapTracker, IndexDoesNotWrap) {
  constexpr daq::ScanIndex kFar = 6'311'520'000'000;
  GapTracker tracker;
  EXPECT_FALSE(tracker.observe(block_at(kFar, 64)));
  const auto gap = tracker.observe(block_at(kFar + (std::int64_t{1} << 32), 1));
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->count, (std::int64_t{1} << 32) - 64);
}

TEST(GapCause, NamesAreDistinct) {
  const std::set<std::string_view> names{name(GapCause::kUnknown), name(GapCause::kOverrun),
                                         name(GapCause::kRingFull), name(GapCause::kBoardMissing),
                                         name(GapCause::kMissingScans)};
  EXPECT_EQ(names.size(), 5U);
}

}  // namespace
}  // namespace stickslip::test
