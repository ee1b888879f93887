// Two threads, no sleeps: what the consumer saw and what it noticed to be missing must together be
// exactly what the producer made, in order.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "core/daq/gap.hpp"
#include "core/daq/scan_ring.hpp"

namespace stickslip::test {
namespace {

using daq::ScanBlock;
using daq::ScanRing;

constexpr std::int64_t kBlockCount = 200'000;

double reading(daq::ScanIndex index) { return static_cast<double>(index % 65'521); }

/// Blocks of 1 … 64 scans, each reading a function of its index.
struct Producer {
  ScanRing& ring;
  daq::ScanIndex end = 0;

  void run() {
    for (std::int64_t i = 0; i < kBlockCount; ++i) {
      ScanBlock block;
      block.first = end;
      block.count = 1U + static_cast<std::uint32_t>(i * 37 % 64);
      block.stamp = {end, end};
      for (std::uint32_t k = 0; k < block.count; ++k) block.raw[k] = reading(end + k);
      ring.push(block);
      end = block.end();
    }
  }
};

struct Consumer {
  daq::GapTracker tracker;
  daq::ScanIndex next = 0;
  std::int64_t seen = 0;
  std::int64_t missing = 0;
  std::int64_t disorder = 0;

  void take(const ScanBlock& block) {
    if (block.first < next || block.stamp.monotonic_ns != block.first) ++disorder;
    for (std::uint32_t k = 0; k < block.count; ++k) {
      if (block.raw[k] != reading(block.first + k)) ++disorder;
    }
    if (const auto gap = tracker.observe(block)) {
      if (gap->first != next || gap->first + gap->count != block.first) ++disorder;
      missing += gap->count;
    } else if (block.first != next) {
      missing += block.first - next;  // before the first block ever
    }
    seen += block.count;
    next = block.end();
  }
};

TEST(ScanRingStress, EveryScanIsSeenInOrderOrCountedAsLost) {
  ScanRing ring(16);
  Producer producer{ring};
  Consumer consumer;
  std::atomic<bool> finished{false};
  std::thread producing([&] {
    producer.run();
    finished.store(true, std::memory_order_release);
  });
  std::array<ScanBlock, 5> blocks;
  for (bool last_look = false;;) {
    const std::size_t count = ring.pop(blocks.data(), blocks.size());
    for (std::size_t i = 0; i < count; ++i) consumer.take(blocks[i]);
    if (count > 0) continue;
    if (last_look) break;
    last_look = finished.load(std::memory_order_acquire);
    std::this_thread::yield();
  }
  producing.join();

  EXPECT_EQ(consumer.disorder, 0);
  const std::int64_t lost_at_the_end = producer.end - consumer.next;
  EXPECT_EQ(consumer.seen + consumer.missing + lost_at_the_end, producer.end);
  EXPECT_EQ(static_cast<std::int64_t>(ring.dropped_scan_count()), consumer.missing + lost_at_the_end);
}

// With room for everything nothing may be lost.
TEST(ScanRingStress, NothingIsLostInARingThatIsLargeEnough) {
  ScanRing ring(static_cast<std::size_t>(kBlockCount));
  Producer producer{ring};
  Consumer consumer;
  std::thread producing([&] { producer.run(); });
  ScanBlock block;
  for (std::int64_t taken = 0; taken < kBlockCount;) {
    if (ring.pop(&block, 1) == 0) {
      std::this_thread::yield();
      continue;
    }
    consumer.take(block);
    ++taken;
  }
  producing.join();
  EXPECT_EQ(consumer.disorder, 0);
  EXPECT_EQ(consumer.missing, 0);
  EXPECT_EQ(consumer.seen, producer.end);
  EXPECT_EQ(ring.dropped_scan_count(), 0U);
}

}  // namespace
}  // namespace stickslip::test
