/// \file
/// Processor: takes blocks of scans from the ring buffer, notes gaps, calibrates the scans, cuts them into
/// tests, analyses each test, and hands all of it to the sinks.
///
///     Processor processor{settings, calibration, {&table, &record}};
///     while (ring.pop(&block, 1)) processor.process(block, daq::GapCause::kUnknown);
///     processor.finish(EndCause::kStopped);
///
/// The analysis of a test gets the scans that the sinks get, from the first pre-trigger scan to the end, and
/// the gaps between them. So a record that is analysed again gives the same results to the last bit, unless
/// its storage lost scans (daq::GapCause::kStorageFull).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/clock_watch.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/rate_meter.hpp"
#include "core/daq/recorded_facts.hpp"
#include "core/daq/scan_block.hpp"
#include "core/daq/second_channel.hpp"
#include "core/pipeline/bench_state.hpp"
#include "core/pipeline/command_report.hpp"
#include "core/pipeline/segmenter.hpp"
#include "core/pipeline/self_check.hpp"
#include "core/pipeline/sink.hpp"
#include "core/pipeline/test_facts.hpp"

namespace stickslip::pipeline {

struct ProcessorSettings {
  // The A/D step of both is taken from the calibration. Both scan rates must be the granted one.
  SegmenterSettings segmenter;
  analysis::AnalysisSettings analysis;
  std::int64_t first_test_number = 1;
  bool automatic = true;  ///< The bench arms itself after each test, and when scans arrive.
  /// One past the last scan of the acquisition before this one: the first block may then follow a gap.
  /// Nullopt for the first acquisition.
  std::optional<daq::ScanIndex> continues_at;
  /// Facts of the record that is replayed; null for a bench. They replace clock anchors, read latency,
  /// self-check (if it has one), unloaded level, and of a gap of the same scans cause and Gap::estimated. The
  /// first anchor gives the date at which a calibration may have expired. The sinks get its notes during the
  /// test, and its start and stop are carried out again. With a start, force begins no test.
  std::shared_ptr<const daq::RecordedFacts> recorded;
  std::optional<daq::SecondChannel> second;  ///< Second channel of the board; nullopt if there is none.
  /// Whether the stamps are of the machine's own clock. If not, tests have no stalls; they have clock
  /// anchors, measured scan rate and read latency only by `recorded`.
  bool clock_is_real = true;
  CalibrationInUse calibration = {};
};

/// Thread-bound: the processing thread.
class Processor {
 public:
  /// Tells the sinks, in this thread, that the bench is idle or armed: scans are expected.
  /// \param sinks  called in this order; they outlive the processor.
  /// \throws std::invalid_argument as Segmenter.
  Processor(const ProcessorSettings& settings, daq::Calibration calibration, std::vector<Sink*> sinks);

  /// Takes the next block, in the order of the indices.
  /// \param block  not empty.
  /// \param gap_cause  cause of the gap, if the index jumps before this block.
  /// \param halted  the board had halted before this block: the size of a gap is then an estimate.
  void process(const daq::ScanBlock& block, daq::GapCause gap_cause, bool halted = false);

  /// To be called after the last block: ends a running test with the latest scan; the bench is then degraded.
  void finish(EndCause cause);
  /// To be called after finish(): `count` scans, ≥ 0, came after the latest block and were lost on the way
  /// here. Tells the sinks a gap between tests of cause kRingFull, unless `count` is 0.
  void lost_at_end(std::int64_t count);

  // Commands, in processor_commands.cpp; between two blocks. One that is refused changes nothing; its report
  // says why. arm(), start() and stop() are refused as by step(). `who` is the name of the user.

  /// Arms the bench: force above the trigger begins a test, also if it is there already.
  [[nodiscard]] CommandReport arm(const std::string& who);
  /// Begins a test; the next scan is its trigger scan.
  [[nodiscard]] CommandReport start(const std::string& who);
  /// Ends the running test with the latest scan, or cancels a start() before its first scan; without either,
  /// disarms the armed bench.
  [[nodiscard]] CommandReport stop(const std::string& who);
  /// Adds a remark at the latest scan of the running test; refused without one.
  [[nodiscard]] CommandReport mark(const std::string& text);
  /// Sets the zero of the load cell from the next scan on, and for the scans kept for the next test, so that
  /// the mean force of the unloaded scans before (up to IdleScans::kKept_s) is zero. Ends
  /// BenchState::kFinishing. Refused during a test, without scans from the board, without readings in volts
  /// or counts, with too few unloaded scans, with the converter at a rail, and if that mean is a load: as a
  /// coefficient, the larger of SegmenterSettings::start_coefficient and UnloadedLevel::kFarthest or more.
  /// Sinks learn the zero only from a note in the next test: the caller sets it in the header of their
  /// records.
  [[nodiscard]] TareReport tare(const std::string& who);
  /// Replaces the calibration from the next scan on. Refused unless the bench is idle. Scans kept for the
  /// next test are dropped: its record begins after this call. Those kept for its self-check and for tare()
  /// are dropped too, and the unloaded level is that of the settings again. Sinks learn the
  /// calibration only from a note in the next test: the caller sets it in the header of their records.
  /// \param calibration  of the same board.
  /// \param in_use  as ProcessorSettings::calibration.
  [[nodiscard]] CommandReport recalibrate(daq::Calibration calibration, const CalibrationInUse& in_use,
                                          const std::string& who);
  /// Sets the nominal pull speed of the tests that begin from here on; nullopt: unknown. Sinks are not told:
  /// the caller sets it in the header of their records, too.
  void plan_pull_speed(std::optional<double> speed_m_per_s) {
    settings_.analysis.tester.pull_speed_m_per_s = speed_m_per_s;
  }
  /// Sets the method of the tests that begin from here on. Sinks are not told, as by plan_pull_speed().
  void plan_method(const model::Method& method) { settings_.analysis.method = method; }

  [[nodiscard]] BenchState bench() const noexcept { return bench_.state(); }
  [[nodiscard]] BenchTrouble bench_trouble() const noexcept { return trouble_; }
  [[nodiscard]] const daq::Calibration& calibration() const noexcept { return calibration_; }
  [[nodiscard]] bool test_is_running() const noexcept { return analysis_.has_value(); }
  /// Number of the running test, else of the next one.
  [[nodiscard]] std::int64_t test_number() const noexcept { return number_; }
  /// Present state of the running test; idle between tests.
  [[nodiscard]] detect::LiveState live() const { return analysis_ ? analysis_->live() : detect::LiveState{}; }
  [[nodiscard]] std::uint64_t scan_count() const noexcept { return scan_count_; }
  [[nodiscard]] std::uint64_t gap_count() const noexcept { return gap_count_; }
  [[nodiscard]] std::int64_t lost_scan_count() const noexcept { return lost_scan_count_; }
  /// Scans that belong to no test; those that the next test may still take are not counted yet.
  [[nodiscard]] std::int64_t idle_scan_count() const noexcept { return idle_scan_count_; }
  /// Meter of the true scan rate, over all scans so far.
  [[nodiscard]] const daq::RateMeter& rate_meter() const noexcept { return meter_; }

 private:
  struct Scan {
    daq::ScanIndex index;
    double raw;
    double coefficient;   ///< Of `raw`, by calibration_; a new zero while the scan waits makes it anew.
    std::int32_t second;  ///< Means nothing where there is no second channel.
  };

  void note_gap(daq::Gap gap);
  /// One scan. \return why it was the last of a test, if it was.
  [[nodiscard]] std::optional<EndCause> observe(const Scan& scan, const daq::ClockStamp& stamp);
  /// Lets the machine take its step, and tells who wants to know. \return why it is refused.
  [[nodiscard]] std::string_view happens(BenchEvent event);
  /// What follows for the machine from the analysis and from the segmenter.
  void follow_bench();
  /// Counts the scans of a state, and tells if they become many.
  void watch_bench();
  void trouble(BenchTrouble trouble);
  /// What the replayed record says was done before, and after, this scan was taken.
  void repeat_start(daq::ScanIndex index);
  /// \return true if that was to stop.
  [[nodiscard]] bool repeat_others(daq::ScanIndex index);
  [[nodiscard]] EndCause stop_again();
  void tell(const daq::Note& note);
  /// Before the next test; told when it begins.
  void note_for_later(std::string text);
  /// What the stamp of a block of the running test tells.
  void note_clocks(const daq::ScanBlock& block);
  /// Of each block: stalls and steps.
  void watch_clocks(const daq::ScanBlock& block);
  void tell_clocks(const daq::Note& note);
  [[nodiscard]] std::shared_ptr<const daq::SelfCheck> self_check() const;
  void note_anchor(const daq::ClockAnchor& anchor);
  /// Clock anchors of the test that ends at `end`, and what they say.
  void finish_clocks(daq::ScanIndex end);
  void discard_waiting() noexcept;
  void begin(daq::ScanIndex trigger, daq::ClockStamp stamp);
  void analyse(const Scan& scan);
  void end(daq::ScanIndex end, EndCause cause);
  [[nodiscard]] bool measures_speed() const noexcept {
    return settings_.second && settings_.second->quantity == daq::SecondQuantity::kPullSpeed;
  }
  void hand_over(const daq::ScanBlock& block, std::size_t from, std::size_t to);
  void report_news();

  ProcessorSettings settings_;
  daq::Calibration calibration_;
  std::vector<Sink*> sinks_;
  daq::GapTracker gaps_;
  Segmenter segmenter_;
  BenchMachine bench_;
  std::deque<Scan> waiting_;  ///< In case a test starts soon; consecutive, the latest last.
  IdleScans idle_;            ///< Those before them.
  std::optional<analysis::TestAnalysis> analysis_;
  std::int64_t number_;
  daq::ScanIndex next_scan_;
  std::uint64_t scan_count_ = 0;
  std::uint64_t gap_count_ = 0;
  std::int64_t lost_scan_count_ = 0;
  std::int64_t idle_scan_count_ = 0;
  daq::RateMeter meter_;
  daq::ClockWatch watch_;
  std::array<double, daq::ScanBlock::kMaxScans> coefficients_{};  ///< Of the latest block.
  std::optional<daq::Note> start_;  ///< The command that begins the next test; its scan is not known yet.
  BenchTrouble trouble_ = BenchTrouble::kNone;
  std::int64_t bench_scans_ = 0;  ///< Since the bench changed its state.
  std::vector<std::string> for_later_;
  std::size_t next_recorded_note_ = 0;
  bool recorded_start_ = false;  ///< The replayed record was begun by a command.
  // Of the running test.
  daq::AnchorPicker picker_;
  daq::ScanIndex trigger_ = 0;
  TestFacts facts_;
  std::shared_ptr<const daq::SelfCheck> self_check_;
  std::vector<daq::ClockAnchor> anchors_;
  std::vector<daq::Gap> test_gaps_;
  std::optional<daq::LatencyHistogram> read_latency_;
};

}  // namespace stickslip::pipeline
