#include "core/daq/scan_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/daq/gap.hpp"

namespace stickslip::test {
namespace {

using daq::ScanBlock;
using daq::ScanRing;

ScanBlock stamped_block(daq::ScanIndex first, std::uint32_t count) {
  ScanBlock block;
  block.first = first;
  block.count = count;
  block.stamp = {first * 10, first * 20};
  for (std::uint32_t i = 0; i < count; ++i) block.raw[i] = static_cast<double>(first) + i;
  return block;
}

TEST(ScanRing, EmptyRingHandsOutNothing) {
  ScanRing ring(4);
  ScanBlock out;
  EXPECT_EQ(ring.pop(&out, 1), 0U);
  EXPECT_EQ(ring.dropped_scan_count(), 0U);
}

TEST(ScanRing, BlocksComeOutWholeAndInOrder) {
  ScanRing ring(4);
  ASSERT_TRUE(ring.push(stamped_block(0, 3)));
  ASSERT_TRUE(ring.push(stamped_block(3, 64)));
  std::array<ScanBlock, 4> out;
  ASSERT_EQ(ring.pop(out.data(), out.size()), 2U);
  EXPECT_EQ(out[0].end(), 3);
  EXPECT_EQ(out[1].first, 3);
  EXPECT_EQ(out[1].count, 64U);
  EXPECT_EQ(out[1].raw[63], 66.0);
  EXPECT_EQ(out[1].stamp.monotonic_ns, 30);
  EXPECT_EQ(out[1].stamp.realtime_ns, 60);
}

TEST(ScanRing, PopNeverHandsOutMoreThanAsked) {
  ScanRing ring(4);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(ring.push(stamped_block(i, 1)));
  std::array<ScanBlock, 4> out;
  EXPECT_EQ(ring.pop(out.data(), 3), 3U);
  EXPECT_EQ(ring.pop(out.data(), 3), 1U);
  EXPECT_EQ(out[0].first, 3);
}

// The new block is dropped, not an old one, and its scans are counted, not the blocks.
TEST(ScanRing, FullRingDropsAndCountsTheNewBlock) {
  constexpr std::size_t kCapacity = 4;
  ScanRing ring(kCapacity);
  daq::ScanIndex next = 0;
  for (std::size_t i = 0; i < kCapacity; ++i, next += 7) ASSERT_TRUE(ring.push(stamped_block(next, 7)));
  EXPECT_FALSE(ring.push(stamped_block(next, 7)));
  next += 7;
  EXPECT_FALSE(ring.push(stamped_block(next, 5)));
  next += 5;
  EXPECT_EQ(ring.dropped_scan_count(), 12U);

  std::array<ScanBlock, kCapacity> out;
  ASSERT_EQ(ring.pop(out.data(), out.size()), kCapacity);
  EXPECT_EQ(out[0].first, 0);

  // The consumer learns of it by the index.
  ASSERT_TRUE(ring.push(stamped_block(next, 7)));
  daq::GapTracker tracker;
  for (const ScanBlock& block : out) EXPECT_FALSE(tracker.observe(block));
  ASSERT_EQ(ring.pop(out.data(), 1), 1U);
  const auto gap = tracker.observe(out[0], daq::GapCause::kRingFull);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->first, 28);
  EXPECT_EQ(gap->count, 12);
}

// What waited at once: neither what went through nor what waits now.
TEST(ScanRing, HighWaterIsTheMostThatWaitedAtOnce) {
  constexpr std::size_t kCapacity = 4;
  ScanRing ring(kCapacity);
  EXPECT_EQ(ring.use().capacity, kCapacity);
  EXPECT_EQ(ring.use().high_water, 0U);
  std::array<ScanBlock, kCapacity> out;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(ring.push(stamped_block(i, 1)));
  ASSERT_EQ(ring.pop(out.data(), 2), 2U);
  EXPECT_EQ(ring.use().high_water, 3U);
  ASSERT_TRUE(ring.push(stamped_block(3, 1)));
  ASSERT_EQ(ring.pop(out.data(), kCapacity), 2U);
  EXPECT_EQ(ring.use().high_water, 3U);
  for (int i = 4; i < 9; ++i) ring.push(stamped_block(i, 1));
  ASSERT_EQ(ring.pop(out.data(), kCapacity), kCapacity);
  EXPECT_EQ(ring.use().high_water, kCapacity);
}

// A Comedi wake-up comes every 4 to 8 ms (HZ = 250) with 1 to 3 scans at 350 Hz.
TEST(ScanRing, CapacityBridgesAMinuteOfSmallBlocks) {
  EXPECT_GE(ScanRing::capacity_for(350.0), 60.0 / 0.008);
}

// At 100 kHz the blocks are full: 1562.5 of them a second.
TEST(ScanRing, CapacityBridgesAMinuteOfFullBlocks) {
  EXPECT_GE(ScanRing::capacity_for(100e3), 60.0 * 100e3 / ScanBlock::kMaxScans);
  EXPECT_GE(ScanRing::capacity_for(100e3, 120.0), 120.0 * 100e3 / ScanBlock::kMaxScans);
}

}  // namespace
}  // namespace stickslip::test
