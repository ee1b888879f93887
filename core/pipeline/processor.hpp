/// \file
/// The walk of a scan after the ring: gaps noted, calibrated, cut into tests, analysed, handed to
/// the sinks.
///
///     Processor processor{settings, calibration, {&table, &record}};
///     while (ring.pop(&block, 1)) processor.process(block, daq::GapCause::kUnknown);
///     processor.finish(EndCause::kStopped);
///
/// What the analysis of a test gets is exactly what its record holds: the scans from the first
/// pre-trigger scan to the end, and the gaps between them. So a record that is analysed again gives
/// the same results to the last bit.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/daq/calibration.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/scan_block.hpp"
#include "core/friction/test_analysis.hpp"
#include "core/pipeline/segmenter.hpp"
#include "core/pipeline/sink.hpp"

namespace stickslip::pipeline {

struct ProcessorSettings {
  // The A/D step of both is taken from the calibration.
  SegmenterSettings segmenter;
  friction::AnalysisSettings analysis;
  std::int64_t first_test_number = 1;
};

/// Thread-bound: the processing thread.
class Processor {
 public:
  /// \param sinks  called in this order; they outlive the processor.
  Processor(const ProcessorSettings& settings, daq::Calibration calibration, std::vector<Sink*> sinks);

  /// Blocks in the order of their indices.
  /// \param gap_cause  what to blame if there is a jump before this block.
  void process(const daq::ScanBlock& block, daq::GapCause gap_cause);

  /// No more blocks: ends the running test, if any.
  void finish(EndCause cause);

  [[nodiscard]] bool test_is_running() const noexcept { return analysis_.has_value(); }
  /// Number of the running test, else of the next one.
  [[nodiscard]] std::int64_t test_number() const noexcept { return number_; }
  /// Phase and regime of the moment; idle between tests.
  [[nodiscard]] friction::LiveState live() const {
    return analysis_ ? analysis_->live() : friction::LiveState{};
  }
  [[nodiscard]] std::uint64_t scan_count() const noexcept { return scan_count_; }
  [[nodiscard]] std::uint64_t gap_count() const noexcept { return gap_count_; }

 private:
  /// A scan kept in case a test starts soon.
  struct Waiting {
    daq::ScanIndex index;
    double raw;
  };

  void note_gap(const daq::Gap& gap);
  void begin(daq::ScanIndex trigger, const daq::ClockStamp& stamp);
  void analyse(daq::ScanIndex index, double raw);
  void end(daq::ScanIndex end, EndCause cause);
  void hand_over(const daq::ScanBlock& block, std::size_t from, std::size_t to);
  void report_new_cycles();

  ProcessorSettings settings_;
  daq::Calibration calibration_;
  std::vector<Sink*> sinks_;
  daq::GapTracker gaps_;
  Segmenter segmenter_;
  std::deque<Waiting> waiting_;  ///< Consecutive, the latest last.
  std::optional<friction::TestAnalysis> analysis_;
  std::int64_t number_;
  daq::ScanIndex next_scan_ = 0;
  std::uint64_t scan_count_ = 0;
  std::uint64_t gap_count_ = 0;
};

}  // namespace stickslip::pipeline
