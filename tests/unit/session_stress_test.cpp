// Lives of a session, one behind the other as a reload has them, under threads that give commands, look on
// and stop it. What has to hold is an order: of scans, of tests, of commands among themselves, behind the
// scans before them and before the end.

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/runtime/session.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip::runtime {
namespace {

constexpr double kRate_Hz = 350.0;
constexpr int kLives = test::kSanitized ? 12 : 60;

/// Pulls of 2 s with 1 s between them, without end, in blocks of 1 … 64 scans; some scans are missing.
class Endless final : public daq::Board {
 public:
  explicit Endless(daq::ScanIndex first) : next_(first) {
    info_.quantity = daq::RawQuantity::kCoefficient;
    info_.scan_rate_granted_Hz = kRate_Hz;
  }
  [[nodiscard]] const daq::BoardInfo& info() const noexcept override { return info_; }
  [[nodiscard]] base::Result<void> start() override { return {}; }
  [[nodiscard]] daq::ReadStatus read(daq::ScanBlock& block, std::chrono::milliseconds) noexcept override {
    ++reads_;
    if (reads_ % 1000 == 0) next_ += 3;
    block.first = next_;
    block.count = 1U + static_cast<std::uint32_t>(reads_ * 37 % daq::ScanBlock::kMaxScans);
    for (std::uint32_t k = 0; k < block.count; ++k) block.raw[k] = coefficient(next_ + k);
    next_ += block.count;
    const auto now_ns = static_cast<std::int64_t>(static_cast<double>(next_) * 1e9 / kRate_Hz);
    block.stamp = {now_ns, now_ns};
    return daq::ReadStatus::kScans;
  }
  void stop() noexcept override {}

 private:
  static double coefficient(daq::ScanIndex scan) {
    const double t_s = std::fmod(static_cast<double>(scan) / kRate_Hz, 3.0);
    return t_s < 2.0 ? std::min(t_s, 0.3) : 0.0;
  }

  daq::BoardInfo info_;
  daq::ScanIndex next_;
  std::int64_t reads_ = 0;
};

/// Looks whether what comes is in order. Of the processing thread, but for `seen`.
class Witness final : public pipeline::Sink {
 public:
  explicit Witness(daq::ScanIndex first, std::int64_t first_test) : next_(first), next_test_(first_test) {}

  void test_began(const pipeline::TestStart& start) override {
    if (in_test_) wrong("a test began in a test");
    if (start.number != next_test_) wrong("the numbers of tests do not go on");
    in_test_ = true;
    next_of_test_ = start.first;
  }
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> /*second*/,
             const daq::ClockStamp& /*stamp*/) override {
    if (!in_test_) wrong("scans of no test");
    if (first != next_of_test_) wrong("scans of a test do not go on");
    next_of_test_ = first + std::ssize(raw);
  }
  void gap(const daq::Gap& gap) override {
    if (!in_test_ || gap.first != next_of_test_) wrong("a gap stands elsewhere");
    next_of_test_ = gap.first + gap.count;
    lose(gap);
  }
  void gap_between_tests(const daq::Gap& gap) override {
    if (in_test_) wrong("a gap between tests in a test");
    lose(gap);
  }
  void test_ended(const pipeline::TestEnd& end) override {
    if (!in_test_) wrong("the end of no test");
    if (end.number != next_test_) wrong("the end of another test");
    if (end.end != next_of_test_) wrong("a test ends elsewhere than its scans");
    in_test_ = false;
    ++next_test_;
  }
  void observed(daq::ScanIndex first, std::span<const double> coefficient,
                const detect::LiveState& /*live*/) override {
    if (over) wrong("scans behind the end");
    if (first != next_) wrong("scans out of order");
    next_ = first + std::ssize(coefficient);
    seen.fetch_add(std::ssize(coefficient), std::memory_order_relaxed);
  }

  void wrong(const std::string& what) {
    if (std::find(wrongs.begin(), wrongs.end(), what) == wrongs.end()) wrongs.push_back(what);
  }
  [[nodiscard]] bool in_test() const { return in_test_; }
  [[nodiscard]] daq::ScanIndex next() const { return next_; }
  [[nodiscard]] std::int64_t next_test() const { return next_test_; }

  std::atomic<std::int64_t> seen{0};
  bool over = false;
  std::vector<std::string> wrongs;

 private:
  void lose(const daq::Gap& gap) {
    if (gap.first != next_) wrong("a gap out of order");
    next_ = gap.first + gap.count;
  }

  bool in_test_ = false;
  daq::ScanIndex next_;
  daq::ScanIndex next_of_test_ = 0;
  std::int64_t next_test_;
};

/// Gives commands, each with its number, until none is taken any more.
class Commander {
 public:
  Commander(Session& session, Witness& witness) : session_(session), witness_(witness) {}

  void run(const std::atomic<bool>& over) {
    while (!over.load(std::memory_order_relaxed)) {
      // All blocks of which the count tells are in the ring, the last one perhaps on its way there.
      const auto delivered = static_cast<std::int64_t>(session_.delivered_scan_count());
      const std::int64_t number = accepted_ + 1;
      if (!session_.post([this, number, delivered](pipeline::Processor&) { called(number, delivered); })) {
        std::this_thread::yield();
        continue;
      }
      accepted_ = number;
    }
  }
  [[nodiscard]] std::int64_t accepted() const { return accepted_; }
  [[nodiscard]] std::int64_t called() const { return called_; }

 private:
  void called(std::int64_t number, std::int64_t delivered) {
    if (number != ++called_) witness_.wrong("commands out of order");
    if (witness_.over) witness_.wrong("a command behind the end");
    if (witness_.seen.load(std::memory_order_relaxed) < delivered - std::int64_t{daq::ScanBlock::kMaxScans})
      witness_.wrong("a command before scans that were there before it");
  }

  Session& session_;
  Witness& witness_;
  std::int64_t accepted_ = 0;  ///< Of its own thread.
  std::int64_t called_ = 0;    ///< Of the processing thread.
};

/// Reads what any thread may, until the end; counts only ever rise.
void look_on(const Session& session, const SessionCounts& counts, const std::atomic<bool>& over,
             std::atomic<int>& falls) {
  std::uint64_t processed_before = 0;
  std::int64_t issued_before = 0;
  while (!over.load(std::memory_order_relaxed)) {
    const std::uint64_t processed = counts.scans.load(std::memory_order_relaxed);
    const std::int64_t issued = session.issued_index_count();
    if (processed < processed_before || issued < issued_before) ++falls;
    processed_before = processed;
    issued_before = issued;
    static_cast<void>(session.live());
    static_cast<void>(session.clocks());
    static_cast<void>(session.bench());
    static_cast<void>(session.ring_use());
  }
}

struct Leaves {
  std::optional<daq::Continuation> continuation;
  std::int64_t next_test = 1;
};

/// One life, that two threads end when `lasts` scans have been seen.
Leaves live_once(const Leaves& before, std::int64_t lasts, std::int64_t& commands) {
  const daq::ScanIndex first = before.continuation ? before.continuation->end : 0;
  SessionSettings settings;
  settings.processor.segmenter.scan_rate_Hz = kRate_Hz;
  settings.processor.analysis.scan_rate_Hz = kRate_Hz;
  settings.processor.clock_is_real = false;
  settings.processor.first_test_number = before.next_test;
  settings.full_ring = FullRing::kWait;
  if (before.continuation) settings.processor.continues_at = first;
  SessionCounts counts;
  Witness witness{first, before.next_test};
  std::atomic<bool> over{false};
  SessionEvents events;
  events.first_scan = [] {};
  events.ended = [&](Acquisition::End end) {
    if (end != Acquisition::End::kStopped) witness.wrong("nobody stopped it");
    witness.over = true;
    over = true;
  };
  const daq::ScanIndex begins = before.continuation ? first + 5 : first;  // Lost between the two.
  Session session{{std::make_unique<Endless>(begins), nullptr, {}, {}, {}, nullptr, {}},
                  settings,
                  {&witness},
                  std::move(events),
                  counts};
  EXPECT_TRUE(session.start());
  std::array commanders{Commander{session, witness}, Commander{session, witness}};
  std::atomic<int> falls{0};
  const auto stop = [&] {
    while (witness.seen.load(std::memory_order_relaxed) < lasts) std::this_thread::yield();
    session.request_stop();
  };
  {
    std::vector<std::jthread> threads;
    for (Commander& commander : commanders) threads.emplace_back([&] { commander.run(over); });
    threads.emplace_back([&] { look_on(session, counts, over, falls); });
    threads.emplace_back(stop);
    threads.emplace_back(stop);
    session.start_processing();
  }
  EXPECT_TRUE(over.load());  // And so all that the processing thread did is seen here.
  EXPECT_FALSE(session.post([](pipeline::Processor&) {}));
  EXPECT_THAT(witness.wrongs, testing::IsEmpty());
  EXPECT_FALSE(witness.in_test());
  EXPECT_EQ(falls, 0);
  for (const Commander& commander : commanders) {
    EXPECT_EQ(commander.called(), commander.accepted());
    commands += commander.called();
  }
  const SessionEnd end = session.end();
  EXPECT_EQ(end.next_test_number, witness.next_test());
  if (!end.before.continuation) {  // Stopped before its first scan.
    EXPECT_EQ(witness.next(), first);
    return {before.continuation, end.next_test_number};
  }
  // Nothing is lost at the end, where the board waits for the ring.
  EXPECT_EQ(end.before.continuation->end, witness.next());
  return {end.before.continuation, end.next_test_number};
}

TEST(SessionStress, LivesBehindEachOtherKeepTheirOrder) {
  Leaves left;
  std::int64_t commands = 0;
  for (int life = 0; life < kLives; ++life) {
    // From a stop before the first scan to one in a later test.
    left = live_once(left, life % 4 == 0 ? 0 : std::int64_t{997} * life, commands);
    ASSERT_FALSE(testing::Test::HasFailure()) << "life " << life;
  }
  EXPECT_GT(left.next_test, kLives / 2);
  EXPECT_GT(commands, kLives);
}

/// Takes so long for each block that the next ones wait in the ring.
class Slow final : public pipeline::Sink {
 public:
  void observed(daq::ScanIndex /*first*/, std::span<const double> coefficient,
                const detect::LiveState& /*live*/) override {
    constexpr std::int64_t kTwoBlocks = 2 * std::int64_t{daq::ScanBlock::kMaxScans};
    seen_ += std::ssize(coefficient);
    if (seen_ >= kLongest) {
      session->request_stop();
      return;
    }
    while (!called && static_cast<std::int64_t>(session->delivered_scan_count()) < seen_ + kTwoBlocks)
      std::this_thread::yield();
  }

  /// Many times what the ring of a board that waits holds.
  static constexpr std::int64_t kLongest = 1'000'000;

  Session* session = nullptr;
  bool called = false;  ///< Of the processing thread.

 private:
  std::int64_t seen_ = 0;
};

TEST(SessionStress, CommandsHaveTheirTurnThoughScansComeFasterThanTheyAreProcessed) {
  SessionSettings settings;
  settings.processor.segmenter.scan_rate_Hz = kRate_Hz;
  settings.processor.analysis.scan_rate_Hz = kRate_Hz;
  settings.processor.clock_is_real = false;
  settings.full_ring = FullRing::kWait;
  SessionCounts counts;
  Slow slow;
  std::atomic<bool> over{false};
  SessionEvents events;
  events.first_scan = [] {};
  events.ended = [&](Acquisition::End) { over = true; };
  Session session{{std::make_unique<Endless>(0), nullptr, {}, {}, {}, nullptr, {}},
                  settings,
                  {&slow},
                  std::move(events),
                  counts};
  slow.session = &session;
  bool before_the_end = false;
  ASSERT_TRUE(session.start());
  ASSERT_TRUE(session.post([&](pipeline::Processor&) {
    slow.called = true;
    before_the_end = counts.scans < static_cast<std::uint64_t>(Slow::kLongest);
    session.request_stop();
  }));
  session.start_processing();
  while (!over) std::this_thread::yield();
  EXPECT_TRUE(before_the_end);
}

}  // namespace
}  // namespace stickslip::runtime
