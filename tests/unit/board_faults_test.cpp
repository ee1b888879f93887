// What the daemon makes of a board's misfortunes, from the command table up to the record.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/record/journal.hpp"
#include "daemon/app/app.hpp"
#include "tests/support/fake_comedi.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip::daemon {
namespace {

using test::FakeComedi;
using test::FakeComediWorld;
using test::ManualClock;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

/// One attempt to open the board, and what becomes of it.
struct Life {
  std::string refused;                 ///< Not empty: opening fails with this.
  std::chrono::nanoseconds absent{0};  ///< Goes by before it.
  FakeComediWorld world;
};

/// Thread-safe; keeps what the daemon had to say.
class Diary final : public EventReceiver {
 public:
  void board_unavailable(std::string_view state, std::string_view why, double /*retry_in_s*/) override {
    const std::lock_guard lock{mutex_};
    losses.push_back(fmt::format("{}: {}", state, why));
  }
  void gap_seen(const daq::Gap& gap, std::optional<std::int64_t> /*test*/) override {
    const std::lock_guard lock{mutex_};
    gaps.push_back(gap);
  }

  void scans_accounted(const ScanAccount& scans) override {
    const std::lock_guard lock{mutex_};
    account = scans;
  }

  std::vector<std::string> losses;
  std::vector<daq::Gap> gaps;
  std::optional<ScanAccount> account;

 private:
  std::mutex mutex_;
};

constexpr double kRate_Hz = 1e9 / 2'857'000.0;  // 350 Hz in whole microseconds

/// Pulled at a coefficient of 0.3: a test that does not end by itself.
std::uint32_t loaded(std::int64_t /*scan*/) {
  constexpr double kWeight_N = 9.80665;
  constexpr double kForce_N = 0.3 * kWeight_N;
  return static_cast<std::uint32_t>(std::lround((kForce_N + 10.0) / 20.0 * 65535.0));
}

/// Runs the daemon through the lives of a board; stops after the last of them.
class BoardFaults : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("stickslip-faults-{}", ::getpid());
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Life& live() {
    Life& life = lives_.emplace_back();
    life.world.signal = loaded;
    return life;
  }

  void run() {
    io::DaemonConfig config;
    config.board.driver = drivers::Driver::kComedi;
    config.bench.sled_mass_kg = 1.0;
    config.bench.load_cell_gain_N_per_V = 1.0;
    config.record_folder = folder_;
    config.realtime = {0, {}, false};  // With a clock moved by hand the thread never waits.
    app::AppWorld world;
    auto clock = std::make_unique<ManualClock>();
    ManualClock& time = *clock;
    world.clock = std::move(clock);
    world.first_retry = 0ms;
    world.events = &diary_;
    world.status_changed = [this](const std::string& line) { lines_.push_back(line); };
    world.finalise = [this](const std::filesystem::path& journal,
                            std::optional<std::int64_t>) -> base::Result<record::Finalised> {
      const auto reading = record::read_journal(journal);
      if (!reading) return tl::unexpected(reading.error());
      records_.push_back(reading->record);
      return record::Finalised{journal, static_cast<std::int64_t>(reading->scan_count), 0, {}};
    };
    app::App* app = nullptr;
    world.open_board = [&](const drivers::BoardConfig&, base::Clock&,
                           const daq::Predecessor& before) -> base::Result<drivers::OpenedBoard> {
      if (app != nullptr) {
        states_.push_back(app->status().state);
        rates_.push_back(app->status().scan_rate_measured);
      }
      if (next_life_ == lives_.size()) {
        if (app != nullptr) app->request_stop();
        return base::failure("no more lives");
      }
      Life& life = lives_[next_life_++];
      time.advance(life.absent);
      if (!life.refused.empty()) return base::failure("{}", life.refused);
      drivers::ComediBoardSettings settings;
      settings.continues = before.continuation;
      settings.before = before.board;
      auto board = drivers::make_comedi_board(settings, time, std::make_unique<FakeComedi>(life.world, time));
      if (!board) return tl::unexpected(board.error());
      return drivers::OpenedBoard{std::move(*board), nullptr, {}, {}, {}, nullptr, {}};
    };
    app::App running{std::move(config), std::move(world)};
    app = &running;
    const auto ended = running.run();
    ASSERT_TRUE(ended) << ended.error().message;
    status_ = running.status();
    expect_all_accounted_for();
  }

  /// Whatever became of the board: by the counters of those who did it, and by what stands in the journals.
  void expect_all_accounted_for() const {
    ASSERT_TRUE(diary_.account);
    const ScanAccount& scans = *diary_.account;
    EXPECT_EQ(scans.under_way(), 0) << scans.issued << " issued";
    EXPECT_EQ(scans.unsaved, 0);
    std::size_t recorded = 0;
    for (const record::Record& record : records_) recorded += record.scan.size();
    EXPECT_EQ(scans.recorded, static_cast<std::int64_t>(recorded));
    std::int64_t in_gaps = 0;
    for (const daq::Gap& gap : diary_.gaps) in_gaps += gap.count;
    EXPECT_EQ(scans.in_gaps, in_gaps);
    EXPECT_EQ(scans.issued, static_cast<std::int64_t>(status_.scan_count) + in_gaps);
  }

  std::filesystem::path folder_;
  std::deque<Life> lives_;
  std::size_t next_life_ = 0;
  Diary diary_;
  std::vector<std::string> lines_;
  std::vector<std::string> states_;  ///< At each attempt to open the board.
  std::vector<std::optional<daq::RateEstimate>> rates_;
  std::vector<record::Record> records_;
  Status status_;
};

TEST_F(BoardFaults, BoardThatGoesAndReturnsLeavesAnIncompleteTestAndAnEstimatedGap) {
  live().world.removed_at_scan = 3500;
  live().refused = "/dev/comedi0: no board behind this device";
  lives_.back().absent = 20s;
  live().absent = 40s;
  lives_.back().world.removed_at_scan = 3500;
  run();

  // The state has its name whenever the daemon tries again.
  EXPECT_EQ(states_,
            (std::vector<std::string>{"starting", "board missing", "board missing", "board missing"}));
  EXPECT_THAT(lines_, Contains(HasSubstr("board missing: /dev/comedi0: no board behind")));
  EXPECT_THAT(diary_.losses, Contains(HasSubstr("no board behind")));
  EXPECT_EQ(status_.board_loss_count, 2U);

  ASSERT_EQ(records_.size(), 2U);
  for (const record::Record& record : records_) {
    ASSERT_TRUE(record.end);
    EXPECT_EQ(record.end->status, record::Status::kIncomplete);
    EXPECT_EQ(record.end->cause, "board-missing");
    EXPECT_THAT(record.end->reasons, Contains(HasSubstr("went away")));
  }
  EXPECT_EQ(records_[1].header.test_number, 2);
  EXPECT_GT(records_[1].scan.front(), records_[0].scan.back());

  // Between the last scan read and the first of the returned board lies all that the clock counted: 60 s.
  // The board went up to 8 ms (a wake-up) and 23 ms (a probe of read()) before that was noticed; rounded
  // twice.
  ASSERT_EQ(diary_.gaps.size(), 1U);
  const daq::Gap gap = diary_.gaps[0];
  EXPECT_EQ(gap.cause, daq::GapCause::kBoardMissing);
  EXPECT_TRUE(gap.estimated);
  EXPECT_EQ(gap.first, records_[0].scan.back() + 1);
  EXPECT_NEAR(static_cast<double>(gap.count), (60.0 + 0.0155) * kRate_Hz, 0.0155 * kRate_Hz + 2.0);
  EXPECT_EQ(status_.gap_count, 1U);
  EXPECT_EQ(status_.lost_scan_count, gap.count);
}

// Both are of one kind, and only the serial number tells them apart.
TEST_F(BoardFaults, AnotherBoardBehindTheSameDeviceFileIsNotTakenInSilence) {
  live().world.serial = "01A2";
  lives_.back().world.removed_at_scan = 3500;
  live().world.serial = "77B0";
  live().world.serial = "01A2";
  lives_.back().world.removed_at_scan = 3500;
  run();
  EXPECT_THAT(diary_.losses,
              Contains(AllOf(HasSubstr("board missing: /dev/comedi0: another board has this device file now: "
                                       "fake-board (fake), serial \"77B0\""),
                             HasSubstr("not serial \"01A2\" as before"))));
  EXPECT_EQ(records_.size(), 2U);
}

TEST_F(BoardFaults, OverrunInATestIsAnEstimatedGapInItsRecord) {
  live().world.overrun_at_scan = 3500;
  lives_.back().world.halt = 7s;
  lives_.back().world.removed_at_scan = 7000;
  run();
  ASSERT_EQ(records_.size(), 1U);
  ASSERT_EQ(records_[0].gaps.size(), 1U);
  const daq::Gap gap = records_[0].gaps[0];
  EXPECT_EQ(gap.cause, daq::GapCause::kOverrun);
  EXPECT_TRUE(gap.estimated);
  EXPECT_EQ(gap.first, 3500);
  // The last scan before the halt lies up to a wake-up of 8 ms before it; rounded twice.
  EXPECT_NEAR(static_cast<double>(gap.count), (7.0 + 0.004) * kRate_Hz, 0.004 * kRate_Hz + 2.0);
  EXPECT_EQ(status_.overrun_count, 1U);
  // Its scans go on to the last one behind the gap.
  EXPECT_GT(records_[0].scan.back(), gap.first + gap.count + 6000);
}

// The kernel's own clock stands still in a suspend, and the date alone would tell that scans are missing.
TEST_F(BoardFaults, ASuspendOfTheComputerIsALossWithItsCause) {
  live().world.suspended_at_scan = 3500;
  lives_.back().world.suspended = 20s;
  lives_.back().world.removed_at_scan = 10500;
  run();
  ASSERT_EQ(diary_.gaps.size(), 1U);
  const daq::Gap& gap = diary_.gaps.front();
  EXPECT_EQ(gap.cause, daq::GapCause::kSuspended);
  EXPECT_TRUE(gap.estimated);
  // What was read last lies up to a wake-up of 8 ms before it, as does the anchor; rounded twice.
  EXPECT_NEAR(static_cast<double>(gap.first), 3500.0, 0.008 * kRate_Hz + 1.0);
  EXPECT_NEAR(static_cast<double>(gap.first + gap.count), 3500.0 + 20.0 * kRate_Hz, 0.016 * kRate_Hz + 2.0);
  ASSERT_EQ(records_.size(), 1U);
  ASSERT_EQ(records_.front().gaps.size(), 1U);
  EXPECT_EQ(records_.front().gaps.front().cause, daq::GapCause::kSuspended);
  EXPECT_EQ(status_.overrun_count, 0U);
  EXPECT_EQ(status_.board_loss_count, 1U);  // The removal alone.
}

TEST_F(BoardFaults, AnotherOwnerIsNamedAndWaitedFor) {
  live().world.used_by_another = true;
  live().world.locked_by_another = true;
  live().world.removed_at_scan = 100;
  run();
  // Whoever holds it, by a command or by a lock, the state says that somebody does.
  EXPECT_EQ(states_, (std::vector<std::string>{"starting", "board busy", "board busy", "board missing"}));
  EXPECT_THAT(diary_.losses, Contains(HasSubstr("board busy: /dev/comedi0: another program is using it")));
  EXPECT_THAT(diary_.losses, Contains(HasSubstr("board busy: /dev/comedi0: subdevice 0 is locked by")));
  EXPECT_THAT(lines_, Contains(HasSubstr("board busy: /dev/comedi0: another program is using it")));
  EXPECT_GT(status_.scan_count, 0U);
}

TEST_F(BoardFaults, LackOfPermissionIsAStateOfItsOwnAndWaitedFor) {
  live().world.open_error = EACCES;
  live().world.removed_at_scan = 100;
  run();
  EXPECT_EQ(states_, (std::vector<std::string>{"starting", "no permission", "board missing"}));
  // Which group it is for depends on the device file; that it is named, not.
  EXPECT_THAT(lines_, Contains(HasSubstr("no permission: /dev/comedi0: permission denied")));
  EXPECT_THAT(diary_.losses, Contains(HasSubstr("group iocard")));
  EXPECT_GT(status_.scan_count, 0U);
}

TEST_F(BoardFaults, RateOfASlowQuartzIsMeasuredRecordedAndFlagged) {
  live().world.clock_error = 1e-3;
  lives_.back().world.removed_at_scan = 10'500;
  run();
  ASSERT_EQ(records_.size(), 1U);
  const analysis::TestResults& results = records_[0].end->results;
  ASSERT_TRUE(results.scan_rate_measured.value) << results.scan_rate_measured.reason;
  const double true_Hz = kRate_Hz / 1.001;
  EXPECT_NEAR(*results.scan_rate_measured.value, true_Hz, 5.0 * *results.scan_rate_measured.standard_error);
  EXPECT_LT(*results.scan_rate_measured.standard_error, 1e-5 * true_Hz);
  EXPECT_GE(records_[0].anchors.size(), 50U);
  // 1/1.001 of the granted rate.
  EXPECT_THAT(base::texts_of(results.findings), Contains(HasSubstr("are 0.99900")));
  ASSERT_TRUE(rates_.back());
  EXPECT_NEAR(rates_.back()->rate_Hz, true_Hz, 1e-4 * true_Hz);
}

TEST_F(BoardFaults, RateOfAGoodQuartzIsNotFlagged) {
  live().world.clock_error = 50e-6;
  lives_.back().world.removed_at_scan = 10'500;
  run();
  ASSERT_EQ(records_.size(), 1U);
  EXPECT_TRUE(records_[0].end->results.scan_rate_measured.value);
  EXPECT_THAT(base::texts_of(records_[0].end->results.findings),
              testing::Not(Contains(HasSubstr("scan rate"))));
}

TEST_F(BoardFaults, HowLateTheScansOfATestWereReadStandsInItsRecord) {
  live().world.removed_at_scan = 3500;
  run();
  ASSERT_EQ(records_.size(), 1U);
  ASSERT_TRUE(records_[0].end->read_latency);
  const daq::LatencyHistogram& latency = *records_[0].end->read_latency;
  // The board wakes its reader each 8 ms, so that a last scan is read up to that late; three scans a block.
  EXPECT_LE(latency.largest_s(), 0.008 + 1e-6);
  EXPECT_GE(latency.largest_s(), 0.001);
  const auto reads = std::accumulate(latency.counts().begin(), latency.counts().end(), std::uint64_t{0});
  EXPECT_GE(reads, 1100U);
  EXPECT_LE(reads, 1260U);
}

// Whatever happens in whatever order: each loss has a text, indices only rise, every jump is a gap of the
// record or of the log, every test is recorded with its reason.
TEST_F(BoardFaults, NoSequenceOfFaultsLeavesTheDaemonUnnamed) {
  const unsigned seed = 20'261'122;
  std::minstd_rand random{seed};
  SCOPED_TRACE(seed);
  const int lives = test::kSanitized ? 10 : 60;
  for (int i = 0; i < lives; ++i) {
    Life& life = live();
    life.absent = std::chrono::milliseconds(random() % 5000);
    const auto at = static_cast<std::int64_t>(random() % 2000);
    switch (random() % 6) {
      case 0:
        life.refused = "/dev/comedi0: no such device";
        break;
      case 1:
        life.world.used_by_another = true;
        break;
      case 2:
        life.world.locked_by_another = true;
        break;
      case 3:
        life.world.wake_interval = 10min;  // falls silent at once
        break;
      case 4:
        life.world.overrun_at_scan = at / 2;
        life.world.halt = std::chrono::milliseconds(random() % 20'000);
        [[fallthrough]];
      default:
        life.world.removed_at_scan = at;
    }
  }
  run();
  EXPECT_EQ(next_life_, lives_.size());
  for (const std::string& state : states_) {
    EXPECT_THAT(state, testing::AnyOf("starting", "board missing", "board busy"));
  }
  for (const std::string& loss : diary_.losses) EXPECT_FALSE(loss.empty());
  EXPECT_EQ(diary_.losses.size(), lives_.size() + 1);  // the attempt after the last life is one too
  daq::ScanIndex end = 0;
  for (const record::Record& record : records_) {
    ASSERT_TRUE(record.end);
    EXPECT_EQ(record.end->status, record::Status::kIncomplete);
    ASSERT_FALSE(record.scan.empty());
    EXPECT_GE(record.scan.front(), end);
    end = record.scan.back() + 1;
  }
  daq::ScanIndex after = 0;
  std::int64_t lost = 0;
  for (const daq::Gap& gap : diary_.gaps) {
    EXPECT_GE(gap.first, after);
    EXPECT_GT(gap.count, 0);
    EXPECT_TRUE(gap.estimated);
    EXPECT_NE(gap.cause, daq::GapCause::kUnknown);
    after = gap.first + gap.count;
    lost += gap.count;
  }
  EXPECT_EQ(status_.lost_scan_count, lost);
  // Every index from the first to the last was read or is in a gap: none is claimed twice, none forgotten.
  EXPECT_GE(static_cast<std::int64_t>(status_.scan_count) + lost, end);
}

}  // namespace
}  // namespace stickslip::daemon
