/// \file
/// What the benchmarks of the whole pipeline share: a simulated tester as fast as it can be, settings as
/// stickslipd makes them, and the walk of one long test as the record gets it.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/clock.hpp"
#include "core/pipeline/processor.hpp"
#include "core/record/record.hpp"
#include "daemon/runtime/session.hpp"
#include "drivers/factory/factory.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::bench {

/// The paper's Fig. 3 with pulls of `pull_s`: 20 slips a second for as long.
class LongPull {
 public:
  LongPull(double scan_rate_Hz, double pull_s, int tests) : clock_(base::make_system_clock(kUnpaced)) {
    const std::filesystem::path shipped =
        std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes/stick-slip-at-12-in-per-min.toml";
    const std::string text = std::regex_replace(test::content_of(shipped), std::regex{"\npull = [^\n]*"},
                                                "\npull = \"" + std::to_string(pull_s) + " s\"");
    test::write_content(folder_ / "pull.toml", text);
    config_.simulated = {{folder_ / "pull.toml"}, tests, scan_rate_Hz};
  }

  /// At its first scan.
  [[nodiscard]] drivers::OpenedBoard open() {
    base::Result<drivers::OpenedBoard> board = drivers::open_board(config_, *clock_);
    if (!board) throw std::runtime_error(board.error().message);
    return std::move(*board);
  }

 private:
  /// So many seconds of the board in one: scans are always due.
  static constexpr double kUnpaced = 1e6;

  test::TemporaryFolder folder_;
  std::unique_ptr<base::Clock> clock_;
  drivers::BoardConfig config_;
};

/// As the daemon's, where nothing but the scene is known.
inline runtime::SessionSettings session_settings(const drivers::OpenedBoard& board,
                                                 detect::EstimatorTier tier) {
  runtime::SessionSettings settings;
  settings.load_cell = *board.load_cell;
  settings.full_ring = runtime::FullRing::kWait;
  settings.processor.clock_is_real = false;
  settings.processor.segmenter.scan_rate_Hz = board.board->info().scan_rate_granted_Hz;
  settings.processor.analysis.scan_rate_Hz = board.board->info().scan_rate_granted_Hz;
  settings.processor.analysis.tester = *board.tester;
  settings.processor.analysis.estimator = tier;
  return settings;
}

inline record::RecordHeader record_header(const drivers::OpenedBoard& board) {
  record::RecordHeader header;
  header.board = board.board->info();
  header.load_cell = board.load_cell;
  header.tester = record::TesterFacts::of(*board.tester);
  header.process.program = "bench";
  return header;
}

/// What the processor hands to a sink, kept to be handed over again.
class Walk final : public pipeline::Sink {
 public:
  void test_began(const pipeline::TestStart& start) override { start_ = start; }
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> /*second*/,
             const daq::ClockStamp& stamp) override {
    steps_.push_back({first, {raw.begin(), raw.end()}, stamp, {}});
    scan_count_ += raw.size();
  }
  void cycle(const detect::Cycle& cycle) override { steps_.back().cycles.push_back(cycle); }
  void test_ended(const pipeline::TestEnd& end) override { end_ = end; }

  void hand_over(pipeline::Sink& sink) const {
    sink.test_began(start_);
    for (const Step& step : steps_) {
      sink.scans(step.first, step.raw, {}, step.stamp);
      for (const detect::Cycle& cycle : step.cycles) sink.cycle(cycle);
    }
    sink.test_ended(end_);
  }
  [[nodiscard]] std::size_t scan_count() const noexcept { return scan_count_; }
  /// Raw readings of the test.
  [[nodiscard]] std::vector<double> raw() const {
    std::vector<double> raw;
    for (const Step& step : steps_) raw.insert(raw.end(), step.raw.begin(), step.raw.end());
    return raw;
  }

 private:
  /// One block and the cycles that were known after it.
  struct Step {
    daq::ScanIndex first;
    std::vector<double> raw;
    daq::ClockStamp stamp;
    std::vector<detect::Cycle> cycles;
  };
  pipeline::TestStart start_;
  std::vector<Step> steps_;
  pipeline::TestEnd end_;
  std::size_t scan_count_ = 0;
};

/// All blocks of the board.
inline std::vector<daq::ScanBlock> all_blocks(daq::Board& board) {
  std::vector<daq::ScanBlock> blocks;
  daq::ScanBlock block;
  if (!board.start()) throw std::runtime_error(board.last_error());
  while (board.read(block, std::chrono::milliseconds{100}) == daq::ReadStatus::kScans)
    blocks.push_back(block);
  return blocks;
}

}  // namespace stickslip::bench
