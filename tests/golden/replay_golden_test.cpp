// Live, replay and batch are one walk: the same scans give the same results to the last bit.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/evaluation/analyse.hpp"
#include "core/pipeline/processor.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/method_text.hpp"
#include "core/record/reader.hpp"
#include "core/record/tester_file.hpp"
#include "drivers/factory/factory.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/record_equality.hpp"

namespace stickslip::evaluation {
namespace {

using namespace std::chrono_literals;

/// Keeps every test as a record.
class Collector final : public pipeline::Sink {
 public:
  explicit Collector(record::RecordHeader header) : header_(std::move(header)) {}

  void test_began(const pipeline::TestStart& start) override {
    record::Record record;
    record.header = header_;
    record.header.uuid = record::make_uuid();
    record.header.test_number = start.number;
    record.header.trigger_scan = start.trigger;
    record.header.plan.unloaded_level = start.unloaded_level;
    if (start.self_check) record.header.self_check = *start.self_check;
    records_.push_back(std::move(record));
  }
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
             const daq::ClockStamp&) override {
    for (const double value : raw) {
      records_.back().scan.push_back(first++);
      records_.back().raw.push_back(value);
    }
    records_.back().second.insert(records_.back().second.end(), second.begin(), second.end());
  }
  void gap(const daq::Gap& gap) override { records_.back().gaps.push_back(gap); }
  void anchor(const daq::ClockAnchor& anchor) override { records_.back().anchors.push_back(anchor); }
  void test_ended(const pipeline::TestEnd& end) override {
    record::EndRecord record;
    record.cause = pipeline::name(end.cause);
    record.results = end.results;
    record.cycles = end.cycles;
    record.spikes = end.spikes;
    record.unloaded_level = end.unloaded_level;
    record::set_end(records_.back(), std::move(record));
  }

  [[nodiscard]] const std::vector<record::Record>& records() const { return records_; }

 private:
  record::RecordHeader header_;
  std::vector<record::Record> records_;
};

/// Plays the board to its end through the processor, in blocks of random sizes.
/// \param lost  one scan in so many is dropped; 0: none.
/// \param characterisation  of the tester, as in the configuration; empty: what the board knows of it.
/// \param skipped  by the configuration, beside those that a replayed record skipped.
/// \param estimator  of the configuration; empty: that of a replayed record.
std::vector<record::Record> run(drivers::OpenedBoard opened, unsigned seed, int lost,
                                const std::string& characterisation = {},
                                const analysis::SkippedCorrections& skipped = {},
                                const std::string& estimator = {}) {
  const daq::BoardInfo& info = opened.board->info();
  record::RecordHeader header;
  header.board = info;
  header.load_cell = opened.load_cell;
  header.tester = record::TesterFacts::of(*opened.tester);
  header.process.method = record::method_text({});
  header.plan.start_coefficient = pipeline::SegmenterSettings{}.start_coefficient;
  header.process.characterisation = characterisation.empty() ? opened.characterisation : characterisation;
  header.process.estimator = estimator.empty() ? opened.estimator : estimator;
  header.process.kept =
      analysis::text_of(analysis::either(skipped, *analysis::skipped_from_text(opened.kept)));
  Collector collector{header};

  pipeline::ProcessorSettings settings;
  settings.segmenter.scan_rate_Hz = info.scan_rate_granted_Hz;
  settings.analysis.scan_rate_Hz = info.scan_rate_granted_Hz;
  settings.analysis.tester = *opened.tester;
  settings.analysis.skipped = analysis::either(skipped, *analysis::skipped_from_text(opened.kept));
  settings.analysis.estimator = record::estimator_of(header.process).value();
  settings.recorded = opened.recorded;
  settings.second = info.second;
  if (!header.process.characterisation.empty()) {
    const auto known = record::parse_tester(header.process.characterisation, "characterisation");
    EXPECT_TRUE(known) << known.error().message;
    if (known) settings.analysis.prior.coupling = *known;
  }
  pipeline::Processor processor{
      settings,
      {info, opened.load_cell.value_or(daq::LoadCell{}), opened.tester->normal_load_N()},
      {&collector}};

  std::minstd_rand random{seed};
  std::uniform_int_distribution<std::uint32_t> size{1, 9};
  EXPECT_TRUE(opened.board->start());
  daq::ScanBlock block;
  while (opened.board->read(block, 1000ms) == daq::ReadStatus::kScans) {
    for (std::uint32_t at = 0; at < block.count;) {
      daq::ScanBlock part;
      part.first = block.first + at;
      part.stamp = block.stamp;
      part.count = std::min(size(random), block.count - at);
      std::copy_n(block.raw.begin() + at, part.count, part.raw.begin());
      part.has_second = block.has_second;
      std::copy_n(block.second.begin() + at, part.count, part.second.begin());
      at += part.count;
      if (lost > 0 && part.first % lost == 0) continue;
      processor.process(part, daq::GapCause::kUnknown);
    }
  }
  processor.finish(pipeline::EndCause::kEndOfInput);
  return collector.records();
}

void expect_same_results(const record::Record& a, const record::Record& b) {
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.raw, b.raw);
  EXPECT_EQ(a.second, b.second);
  EXPECT_EQ(a.spikes, b.spikes);
  EXPECT_EQ(a.anchors, b.anchors);
  EXPECT_EQ(a.end->results, b.end->results);
  ASSERT_EQ(a.cycles.size(), b.cycles.size());
  for (std::size_t i = 0; i < a.cycles.size(); ++i) {
    test::expect_same_bits(a.cycles[i].peak, b.cycles[i].peak, "peak");
    test::expect_same_bits(a.cycles[i].onset_time_s, b.cycles[i].onset_time_s, "onset");
    test::expect_same_bits(a.cycles[i].delta_mu, b.cycles[i].delta_mu, "delta_mu");
    test::expect_same_bits(a.cycles[i].pull_speed_m_per_s, b.cycles[i].pull_speed_m_per_s, "pull_speed");
  }
}

drivers::BoardConfig scene(const char* name) {
  drivers::BoardConfig config;
  config.driver = drivers::Driver::kSimulated;
  config.simulated.scenes = {std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes" / name};
  return config;
}

class ReplayGolden : public testing::TestWithParam<int> {};

TEST_P(ReplayGolden, LiveReplayAndBatchAgreeToTheLastBit) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     fmt::format("stickslip-golden-{}-{}.h5", ::getpid(), GetParam());
  std::filesystem::remove(file);
  struct Bench {
    const char* scene;
    std::optional<double> speed_gain_m_per_s_per_V;  ///< With a speed channel.
  };
  const std::array<Bench, 4> benches{{{"ring-down-at-12-in-per-min.toml", {}},
                                      {"stick-slip-at-12-in-per-min.toml", {}},
                                      {"stick-slip-at-12-in-per-min.toml", 1e-3},
                                      {"speed-ramp.toml", 2e-3}}};
  for (const Bench& bench : benches) {
    SCOPED_TRACE(bench.scene);
    test::ManualClock clock;
    drivers::BoardConfig config = scene(bench.scene);
    config.simulated.speed_gain_m_per_s_per_V = bench.speed_gain_m_per_s_per_V;
    auto simulated = drivers::open_board(config, clock);
    ASSERT_TRUE(simulated) << simulated.error().message;
    const std::vector<record::Record> live = run(std::move(*simulated), 1, GetParam());
    ASSERT_EQ(live.size(), 1U);
    EXPECT_GT(live[0].end->results.cycle_count.value.value_or(0.0), 0.0);
    EXPECT_TRUE(live[0].end->results.scan_rate_measured.value);

    ASSERT_TRUE(record::publish_record(live[0], file));
    const auto stored = record::read_record(file);
    ASSERT_TRUE(stored) << stored.error().message;
    EXPECT_EQ(stored->second.size(), bench.speed_gain_m_per_s_per_V ? stored->raw.size() : 0U);
    const auto batch = analyse(*stored);
    ASSERT_TRUE(batch) << batch.error().message;
    EXPECT_EQ(batch->results, live[0].end->results);
    EXPECT_EQ(batch->spikes, live[0].spikes);
    test::expect_same_cycles(batch->cycles, live[0].cycles);

    drivers::BoardConfig replay;
    replay.driver = drivers::Driver::kReplay;
    replay.replay_file = file;
    auto replayed_board = drivers::open_board(replay, clock);
    ASSERT_TRUE(replayed_board);
    const std::vector<record::Record> replayed = run(std::move(*replayed_board), 2, 0);
    ASSERT_EQ(replayed.size(), 1U);
    expect_same_results(live[0], replayed[0]);
    std::filesystem::remove(file);
  }
}

/// Published, read, analysed and replayed, a test has the results that it had live.
/// \param stored  what was read.
void expect_same_bits_from_file(const record::Record& live, const std::filesystem::path& file,
                                test::ManualClock& clock, std::optional<record::Record>& stored) {
  ASSERT_TRUE(record::publish_record(live, file));
  auto read = record::read_record(file);
  ASSERT_TRUE(read) << read.error().message;
  stored = std::move(*read);
  const auto batch = analyse(*stored);
  ASSERT_TRUE(batch) << batch.error().message;
  EXPECT_EQ(batch->results, live.end->results);

  drivers::BoardConfig replay;
  replay.driver = drivers::Driver::kReplay;
  replay.replay_file = file;
  auto board = drivers::open_board(replay, clock);
  ASSERT_TRUE(board) << board.error().message;
  const std::vector<record::Record> replayed = run(std::move(*board), 2, 0);
  ASSERT_EQ(replayed.size(), 1U);
  EXPECT_EQ(replayed[0].header.process.characterisation, live.header.process.characterisation);
  EXPECT_EQ(replayed[0].header.process.kept, live.header.process.kept);
  EXPECT_EQ(replayed[0].header.process.estimator, stored->header.process.estimator);
  expect_same_results(live, replayed[0]);
}

TEST(ReplayGoldenOfAKnownTester, RecordCarriesWhatWasKnownAndGivesTheSameBits) {
  analysis::Characterisation known;
  known.coupling = {125.6637, 0.022, Eigen::Vector2d{1e-4, 1e-8}.asDiagonal()};
  known.ring_downs = 1;
  const std::string text = record::tester_text(known, "");
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("stickslip-golden-known-{}.h5", ::getpid());
  std::filesystem::remove(file);
  test::ManualClock clock;
  const char* const name = "stick-slip-at-12-in-per-min.toml";
  auto board = drivers::open_board(scene(name), clock);
  ASSERT_TRUE(board) << board.error().message;
  const std::vector<record::Record> live = run(std::move(*board), 1, 0, text);
  ASSERT_EQ(live.size(), 1U);
  auto unknown_board = drivers::open_board(scene(name), clock);
  const std::vector<record::Record> unknown = run(std::move(*unknown_board), 1, 0);
  // It did count: γ of stick and slip alone is ten times less certain.
  EXPECT_LT(*live[0].end->results.gamma_over_2omega.standard_error,
            0.5 * *unknown[0].end->results.gamma_over_2omega.standard_error);

  std::optional<record::Record> stored;
  ASSERT_NO_FATAL_FAILURE(expect_same_bits_from_file(live[0], file, clock, stored));
  EXPECT_EQ(stored->header.process.characterisation, text);

  record::Record damaged = *stored;
  damaged.header.process.characterisation = "[tester]\nomega = 3";
  EXPECT_FALSE(analyse(damaged));
  std::filesystem::remove(file);
}

// Each of the three corrections skipped, on a scene that has it: the record says so, and without that its
// numbers would be others.
TEST(ReplayGoldenOfSkippedCorrections, RecordCarriesItAndGivesTheSameBits) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("stickslip-golden-skipped-{}.h5", ::getpid());
  for (const auto& [name, words] :
       {std::pair{"drift-hum-and-spikes.toml", "spikes"}, std::pair{"drifting-friction.toml", "drift"},
        std::pair{"abnormal-first-peak.toml", "first-slip"},
        std::pair{"drift-hum-and-spikes.toml", "spikes,drift,first-slip"}}) {
    SCOPED_TRACE(words);
    std::filesystem::remove(file);
    test::ManualClock clock;
    auto board = drivers::open_board(scene(name), clock);
    ASSERT_TRUE(board) << board.error().message;
    const std::vector<record::Record> live =
        run(std::move(*board), 1, 0, {}, *analysis::skipped_from_text(words));
    ASSERT_EQ(live.size(), 1U);

    std::optional<record::Record> stored;
    ASSERT_NO_FATAL_FAILURE(expect_same_bits_from_file(live[0], file, clock, stored));
    EXPECT_EQ(stored->header.process.kept, words);

    stored->header.process.kept.clear();
    const auto handled = analyse(*stored);
    ASSERT_TRUE(handled);
    EXPECT_NE(handled->results, live[0].end->results);
    stored->header.process.kept = "hum";
    EXPECT_FALSE(analyse(*stored));
  }
  std::filesystem::remove(file);
}

// By its field, and by the method's text of version 0.1.
TEST(ReplayGoldenOfAnEstimator, RecordCarriesItAndGivesTheSameBits) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("stickslip-golden-estimator-{}.h5", ::getpid());
  for (const std::string word : {"peak", "interpolated"}) {
    SCOPED_TRACE(word);
    test::ManualClock clock;
    auto board = drivers::open_board(scene("stick-slip-at-12-in-per-min.toml"), clock);
    ASSERT_TRUE(board) << board.error().message;
    record::Record live = run(std::move(*board), 1, 0, {}, {}, word).at(0);
    for (const bool version_0_1 : {false, true}) {
      SCOPED_TRACE(version_0_1 ? "of version 0.1" : "of this version");
      if (version_0_1) {
        live.header.process.method += " estimator=" + std::exchange(live.header.process.estimator, {});
      }
      std::filesystem::remove(file);
      std::optional<record::Record> stored;
      ASSERT_NO_FATAL_FAILURE(expect_same_bits_from_file(live, file, clock, stored));
      EXPECT_EQ(stored->header.process.estimator, word);
      EXPECT_EQ(stored->header.process.method, record::method_text({}));

      // It did count.
      stored->header.process.estimator.clear();
      const auto fitted = analyse(*stored);
      ASSERT_TRUE(fitted);
      EXPECT_NE(fitted->results, live.end->results);
    }
  }
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutGaps, ReplayGolden, testing::Values(0, 97));

}  // namespace
}  // namespace stickslip::evaluation
