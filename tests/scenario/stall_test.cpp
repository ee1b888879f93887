// The computer stands still for 10 to 70 s, or its date is set, while a simulated board goes on: the records
// are whole, hold the same results, say so as an event, and claim nothing that follows from late reading.

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <random>

#include "core/pipeline/processor.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "daemon/storage/storage.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::daemon {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// 8 s each, without a pause in which the bench would stand still for long.
const fs::path kScene =
    fs::path{STICKSLIP_SOURCE_DIR} / "config" / "scenes" / "stick-slip-at-12-in-per-min.toml";
constexpr std::int64_t kTests = 8;

struct Trouble {
  double at_s = 0.0;     ///< Of the clock's time.
  double stall_s = 0.0;  ///< Who sleeps then wakes so much later.
  double step_s = 0.0;   ///< The date goes so far ahead.
};

/// Whoever sleeps moves the time, and into the troubles.
class TroubledClock final : public base::Clock {
 public:
  explicit TroubledClock(std::vector<Trouble> troubles) : troubles_(std::move(troubles)) {}
  [[nodiscard]] std::int64_t monotonic_ns() const override { return clock_.monotonic_ns(); }
  [[nodiscard]] std::int64_t realtime_ns() const override { return clock_.realtime_ns(); }
  void sleep_until(std::int64_t deadline_ns) override {
    clock_.sleep_until(deadline_ns);
    while (next_ < troubles_.size() && 1e-9 * static_cast<double>(monotonic_ns()) >= troubles_[next_].at_s) {
      const Trouble& trouble = troubles_[next_++];
      clock_.advance(std::chrono::nanoseconds{std::llround(1e9 * trouble.stall_s)});
      clock_.step_date(std::chrono::nanoseconds{std::llround(1e9 * trouble.step_s)});
    }
  }

 private:
  test::ManualClock clock_;
  std::vector<Trouble> troubles_;
  std::size_t next_ = 0;
};

class Published final : public EventReceiver {
 public:
  void file_published(std::int64_t test, const fs::path& file) override {
    const std::lock_guard lock{mutex_};
    files[test] = file;
  }
  std::map<std::int64_t, fs::path> files;

 private:
  std::mutex mutex_;
};

/// What was told between tests.
class Idle final : public pipeline::Sink {
 public:
  void note_between_tests(const daq::Note& note) override { notes.push_back(daq::to_text(note)); }
  std::vector<std::string> notes;
};

struct Outcome {
  std::vector<record::Record> records;
  std::vector<record::Verdict> verdicts;
  std::vector<std::string> between;
};

Outcome measure(std::vector<Trouble> troubles) {
  const test::TemporaryFolder folder;
  TroubledClock clock{std::move(troubles)};
  drivers::SimulatedBoardSettings board_settings;
  board_settings.scenes = {kScene};
  board_settings.repeats = kTests;
  auto tester = drivers::make_simulated_tester(board_settings, clock);
  if (!tester) throw std::runtime_error(tester.error().message);
  daq::Board& board = *tester->board;

  record::RecordHeader header;
  header.board = board.info();
  header.load_cell = tester->load_cell;
  header.tester = record::TesterFacts::of(tester->tester);
  header.process.program = "stall_test";
  Published published;
  TestLog tests;
  Idle idle;
  storage::Storage storage{{folder / "records"},
                           [](const fs::path& journal, std::optional<std::int64_t> expected) {
                             return record::finalise(journal, {}, record::system_calls(), {}, expected);
                           },
                           tests,
                           published};
  storage.use(header, nullptr);

  pipeline::ProcessorSettings settings;
  settings.segmenter.scan_rate_Hz = settings.analysis.scan_rate_Hz = board.info().scan_rate_granted_Hz;
  settings.analysis.tester = tester->tester;
  pipeline::Processor processor{
      settings, {board.info(), tester->load_cell, tester->tester.normal_load_N()}, {&storage, &idle}};
  if (!board.start()) throw std::runtime_error(board.last_error());
  daq::ScanBlock block;
  for (;;) {
    const daq::ReadStatus status = board.read(block, std::chrono::milliseconds{100});
    if (status == daq::ReadStatus::kEndOfInput) break;
    if (status == daq::ReadStatus::kScans) processor.process(block, daq::GapCause::kUnknown);
  }
  processor.finish(pipeline::EndCause::kEndOfInput);
  storage.stop();

  Outcome outcome;
  for (const auto& [number, file] : published.files) {
    outcome.verdicts.push_back(record::judge(file));
    outcome.records.push_back(record::read_record(file).value());
  }
  outcome.between = idle.notes;
  return outcome;
}

std::vector<std::string> events_of(const record::Record& record, std::string_view kind) {
  std::vector<std::string> texts;
  for (const record::Event& event : record.events) {
    if (event.text.starts_with(kind)) texts.push_back(event.text);
  }
  return texts;
}

void expect_times_of_the_scans(const record::Record& record) {
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  const auto scans = static_cast<double>(record.scan.back() + 1 - *record.header.trigger_scan);
  EXPECT_NEAR(static_cast<double>(*record.end->end_realtime_ns - *record.header.start_realtime_ns),
              1e9 * scans / rate_Hz, 2.0);
}

/// The same scans and the same results, but for what the clocks say.
void expect_same(const record::Record& record, const record::Record& quiet) {
  EXPECT_EQ(record.scan, quiet.scan);
  EXPECT_EQ(record.raw, quiet.raw);
  analysis::TestResults results = record.end->results;
  results.scan_rate_measured = quiet.end->results.scan_rate_measured;
  EXPECT_EQ(results, quiet.end->results);
}

class Stalls : public testing::Test {
 protected:
  static const Outcome& quiet() {
    static const Outcome outcome = measure({});
    return outcome;
  }
};

TEST_F(Stalls, AQuietBenchTellsNothing) {
  ASSERT_EQ(quiet().records.size(), static_cast<std::size_t>(kTests));
  EXPECT_TRUE(quiet().between.empty());
  for (const record::Record& record : quiet().records) {
    EXPECT_TRUE(events_of(record, "stall: ").empty());
    EXPECT_TRUE(events_of(record, "clock step: ").empty());
    ASSERT_TRUE(record.end->results.scan_rate_measured.value);
    EXPECT_NEAR(*record.end->results.scan_rate_measured.value, 350.0, 1e-3);
    expect_times_of_the_scans(record);
  }
}

// Anywhere, once or twice, from the middle of a test to beyond the end of several.
TEST_F(Stalls, RecordsAreWholeAndClaimNoRate) {
  std::mt19937_64 random{20'261'126};
  std::uniform_real_distribution<double> at_s{3.0, 60.0};
  std::uniform_real_distribution<double> stall_s{10.0, 70.0};
  for (int trial = 0; trial < 5; ++trial) {
    const double begin_s = at_s(random);
    const double length_s = stall_s(random);
    std::vector<Trouble> troubles{{begin_s, length_s}};
    if (trial % 2 == 1) troubles.push_back({begin_s + length_s + 2.0 + at_s(random) / 10.0, stall_s(random)});
    const Outcome outcome = measure(troubles);
    SCOPED_TRACE(fmt::format("trial {}: {:.1f} s at {:.1f} s", trial, length_s, begin_s));
    ASSERT_EQ(outcome.records.size(), quiet().records.size());
    std::size_t told = outcome.between.size();
    for (std::size_t i = 0; i < outcome.records.size(); ++i) {
      const record::Record& record = outcome.records[i];
      SCOPED_TRACE(fmt::format("test {}", i + 1));
      EXPECT_EQ(outcome.verdicts[i].judgement, quiet().verdicts[i].judgement);
      expect_same(record, quiet().records[i]);
      EXPECT_THAT(base::texts_of(record.end->results.findings), Not(Contains(HasSubstr("scan rate"))));
      if (record.header.self_check) {
        EXPECT_THAT(record.header.self_check->findings, Not(Contains(HasSubstr("scans at"))));
      }
      if (const auto& rate = record.end->results.scan_rate_measured; rate.value) {
        EXPECT_NEAR(*rate.value, 350.0, 5.0 * *rate.standard_error + 0.035);
      }
      expect_times_of_the_scans(record);
      // In the order of the tests and of the time, although what was read late was read at once.
      if (i > 0) {
        EXPECT_GT(*record.header.start_realtime_ns,
                  *outcome.records[i - 1].header.start_realtime_ns + 4 * kSecond_ns);
      }
      told += events_of(record, "stall: this scan was read ").size();
    }
    EXPECT_GE(told, 1U);
  }
}

TEST_F(Stalls, EachRecordOfScansThatWereReadLateSaysSo) {
  // From the middle of the third test to the end of the sixth.
  const Outcome outcome = measure({{20.0, 28.0}});
  std::vector<std::size_t> told;
  for (const record::Record& record : outcome.records) told.push_back(events_of(record, "stall: ").size());
  EXPECT_THAT(told, testing::ElementsAre(0, 0, 1, 1, 1, 1, 0, 0));
  EXPECT_THAT(events_of(outcome.records[2], "stall: ")[0], testing::HasSubstr("was read 27.9 s late"));
}

TEST_F(Stalls, StepOfTheDateIsAnEventAndNoDuration) {
  for (const double step_s : {3600.0, -1e8}) {
    const Outcome outcome = measure({{20.0, 0.0, step_s}});
    ASSERT_EQ(outcome.records.size(), quiet().records.size());
    for (std::size_t i = 0; i < outcome.records.size(); ++i) {
      const record::Record& record = outcome.records[i];
      const auto told = events_of(record, "clock step: ");
      ASSERT_EQ(told.size(), i == 2 ? 1U : 0U) << step_s << " test " << i + 1;
      if (i == 2) {
        EXPECT_EQ(told[0], fmt::format("clock step: the date went {:.1f} s {}: the clock was set",
                                       std::abs(step_s), step_s > 0.0 ? "ahead" : "back"));
      }
      EXPECT_TRUE(events_of(record, "stall: ").empty());
      expect_times_of_the_scans(record);
      expect_same(record, quiet().records[i]);
    }
  }
}

}  // namespace
}  // namespace stickslip::daemon
