// What a session counts when its ring is full, so that each index is found again.

#include "daemon/runtime/session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/factory/factory.hpp"

namespace stickslip::runtime {
namespace {

/// Gives blocks of one scan as fast as they are read; before some of them it has lost scans.
class Hasty final : public daq::Board {
 public:
  /// \param lost_every  so many blocks; 3 scans are lost before each of these.
  Hasty(std::int64_t block_count, std::int64_t lost_every, double force = 0.0)
      : block_count_(block_count), lost_every_(lost_every), force_(force) {
    info_.quantity = daq::RawQuantity::kCoefficient;
    info_.scan_rate_granted_Hz = 1.0;  // The ring is as small as it gets.
  }

  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return info_; }
  [[nodiscard]] base::Result<void> start() override { return {}; }
  [[nodiscard]] daq::ReadStatus read(daq::ScanBlock& block, std::chrono::milliseconds) noexcept override {
    block.count = 0;
    if (given_ == block_count_) {
      if (!std::exchange(told_, true)) over.set_value();
      return daq::ReadStatus::kEndOfInput;
    }
    if (given_ > 0 && given_ % lost_every_ == 0) next_ += 3;
    block.first = next_++;
    block.count = 1;
    block.raw[0] = force_;
    ++given_;
    return daq::ReadStatus::kScans;
  }
  void stop() noexcept override {}

  std::promise<void> over;

 private:
  daq::BoardInfo info_;
  std::int64_t block_count_;
  std::int64_t lost_every_;
  double force_;
  std::int64_t given_ = 0;
  daq::ScanIndex next_ = 0;
  bool told_ = false;
};

/// Adds up the gaps that a sink is told of.
class Gaps final : public pipeline::Sink {
 public:
  void gap_between_tests(const daq::Gap& gap) override { gaps.push_back(gap); }
  std::vector<daq::Gap> gaps;
};

// The processing thread comes too late: the ring is full, and its last blocks never arrive. Those who lose
// them count them (the ring what it drops, the acquisition what the board lost between them), so the sum is
// a test of the count and not its definition.
TEST(Session, WhatAFullRingDropsAtTheEndIsAGapLikeAnyOther) {
  constexpr std::int64_t kBlocks = 13'000;
  constexpr std::int64_t kLostEvery = 1000;
  const auto capacity = static_cast<std::int64_t>(daq::ScanRing::capacity_for(1.0));
  ASSERT_LT(capacity, kBlocks - 2) << "the ring has to be full before the end";
  auto board = std::make_unique<Hasty>(kBlocks, kLostEvery);
  std::future<void> over = board->over.get_future();
  SessionSettings settings;
  settings.processor.segmenter.scan_rate_Hz = 1.0;
  settings.processor.analysis.scan_rate_Hz = 1.0;
  settings.processor.clock_is_real = false;
  SessionCounts counts;
  Gaps sink;
  std::promise<void> ended;
  SessionEvents events;
  events.first_scan = [] {};
  events.ended = [&ended](Acquisition::End) { ended.set_value(); };
  Session session{
      {std::move(board), nullptr, {}, {}, {}, nullptr, {}}, settings, {&sink}, std::move(events), counts};
  ASSERT_TRUE(session.start());
  over.wait();
  session.start_processing();
  ended.get_future().wait();

  constexpr std::int64_t kLostByBoard = 3 * ((kBlocks - 1) / kLostEvery);
  const std::int64_t dropped = kBlocks - capacity;
  EXPECT_EQ(session.issued_index_count(), kBlocks + kLostByBoard);
  EXPECT_EQ(counts.scans, static_cast<std::uint64_t>(capacity));
  EXPECT_EQ(counts.dropped_scans, static_cast<std::uint64_t>(dropped));
  EXPECT_EQ(counts.lost_scans, dropped + kLostByBoard);
  EXPECT_EQ(counts.idle_scans + counts.lost_scans, session.issued_index_count());
  ASSERT_FALSE(sink.gaps.empty());
  EXPECT_EQ(counts.gaps, sink.gaps.size());
  const daq::Gap& last = sink.gaps.back();
  EXPECT_EQ(last.cause, daq::GapCause::kRingFull);
  // A board that comes back goes on behind the gap: no index is lost twice.
  EXPECT_EQ(last.first + last.count, session.issued_index_count());
  ASSERT_TRUE(session.end().before.continuation);
  EXPECT_EQ(session.end().before.continuation->end, session.issued_index_count());
}

// A command that forgets scans kept for the trigger takes them from no account.
TEST(Session, WhatArmingForgetsIsCounted) {
  constexpr std::int64_t kBlocks = 100;
  auto board = std::make_unique<Hasty>(kBlocks, kBlocks, 0.3);
  std::future<void> over = board->over.get_future();
  SessionSettings settings;
  settings.processor.automatic = false;
  settings.processor.segmenter.scan_rate_Hz = 1.0;
  settings.processor.segmenter.pre_trigger_s = 20.0;
  settings.processor.analysis.scan_rate_Hz = 1.0;
  settings.processor.clock_is_real = false;
  SessionCounts counts;
  std::promise<void> ended;
  SessionEvents events;
  events.first_scan = [] {};
  events.ended = [&ended](Acquisition::End) { ended.set_value(); };
  Session session{
      {std::move(board), nullptr, {}, {}, {}, nullptr, {}}, settings, {}, std::move(events), counts};
  ASSERT_TRUE(session.start());
  over.wait();
  std::string refusal = "not run";
  ASSERT_TRUE(
      session.post([&refusal](pipeline::Processor& processor) { refusal = processor.arm("ada").refusal; }));
  session.start_processing();
  ended.get_future().wait();
  // Either the scans were there when the job ran, or the board had ended already.
  EXPECT_EQ(counts.idle_scans + counts.lost_scans, session.issued_index_count()) << refusal;
}

}  // namespace
}  // namespace stickslip::runtime
