/// \file
/// Sink: receives tests with their scans and results. Record, live page, table and broker are sinks.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/note.hpp"
#include "core/daq/scan_block.hpp"
#include "core/daq/self_check_values.hpp"
#include "core/detect/cycle.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {

/// A test began. Its scans follow, pre-trigger scans first.
struct TestStart {
  std::int64_t number = 0;     ///< Rises by one from test to test.
  daq::ScanIndex first = 0;    ///< First scan that belongs to the test's record.
  daq::ScanIndex trigger = 0;  ///< Scan at which the force or a command began it.
  daq::ClockStamp stamp;       ///< Of the block with the trigger, less its delay if a stall held it up.
  std::shared_ptr<const daq::SelfCheck> self_check;  ///< Null if there were no idle scans.
  bool by_command = false;
  /// Coefficient read by the unloaded cell before it, as Segmenter::unloaded_level().
  std::optional<double> unloaded_level = {};
};

/// Cause of the end of a test.
enum class EndCause {
  kUnloaded,          ///< The force went back to the unloaded level.
  kNoRelativeMotion,  ///< The belt stopped; the coupling stays stretched.
  kEndOfInput,        ///< The source has no more scans.
  kCommand,           ///< A command ended it.
  kStopped,           ///< The program was told to stop.
  kBoardMissing,      ///< The board went away.
};

[[nodiscard]] constexpr std::string_view name(EndCause cause) noexcept {
  switch (cause) {
    case EndCause::kUnloaded:
      return "unloaded";
    case EndCause::kNoRelativeMotion:
      return "no-relative-motion";
    case EndCause::kEndOfInput:
      return "end-of-input";
    case EndCause::kCommand:
      return "command";
    case EndCause::kStopped:
      return "stopped";
    case EndCause::kBoardMissing:
      return "board-missing";
  }
  return "stopped";
}

[[nodiscard]] constexpr std::optional<EndCause> end_cause_from_name(std::string_view text) noexcept {
  for (const EndCause cause : {EndCause::kUnloaded, EndCause::kNoRelativeMotion, EndCause::kEndOfInput,
                               EndCause::kCommand, EndCause::kStopped, EndCause::kBoardMissing}) {
    if (name(cause) == text) return cause;
  }
  return std::nullopt;
}

/// A test ended, with its results.
struct TestEnd {
  std::int64_t number = 0;
  daq::ScanIndex end = 0;  ///< One past the last scan of the record.
  EndCause cause = EndCause::kUnloaded;
  /// Coefficient read by the unloaded cell at the end; nullopt unless the test ended by unloading with a
  /// quiet force.
  std::optional<double> unloaded_level = {};
  analysis::TestResults results;
  base::LongColumn<detect::Cycle> cycles;             ///< Final values, after the whole-test estimate.
  std::vector<daq::ScanIndex> spikes;                 ///< Scans replaced for the detector.
  std::vector<double> spike_coefficients;             ///< Measured coefficient of each spike.
  std::optional<daq::LatencyHistogram> read_latency;  ///< Delays of its blocks; nullopt if none is known.
};

/// Interface of a sink. The processing thread calls it, the first bench_changed() the thread that makes the
/// Processor. Order of a test: began, (scans | gap | anchor | fall | cycle | note)*, ended. Must not throw.
/// Only a sink that must never lose data (the record) may block; it then stalls the processing.
class Sink {
 public:
  virtual ~Sink() = default;

  virtual void test_began(const TestStart& /*start*/) {}
  /// Raw scans of the running test, consecutive, oldest first.
  /// \param second  codes of the second channel: as many, or none if there is no such channel.
  /// \param stamp  of the block with these scans; of the first call TestStart::stamp.
  virtual void scans(daq::ScanIndex /*first*/, std::span<const double> /*raw*/,
                     std::span<const std::int32_t> /*second*/, const daq::ClockStamp& /*stamp*/) {}
  /// Scans missing from the running test.
  virtual void gap(const daq::Gap& /*gap*/) {}
  /// Clock readings at a scan of the running test; in rising order, and after the scan itself.
  virtual void anchor(const daq::ClockAnchor& /*anchor*/) {}
  /// A fall, after the block in which it is detected; if it is a slip, its cycle follows.
  virtual void fall(const detect::FallBegun& /*fall*/) {}
  /// A cycle, after the block in which it is complete, before the whole-test estimate refines it.
  virtual void cycle(const detect::Cycle& /*cycle*/) {}
  /// A note at a scan of the running test; not ordered relative to the scans.
  virtual void note(const daq::Note& /*note*/) {}
  virtual void test_ended(const TestEnd& /*end*/) {}
  /// A disturbance of the computer while no test was running.
  virtual void note_between_tests(const daq::Note& /*note*/) {}
  /// Scans lost while no test was running.
  virtual void gap_between_tests(const daq::Gap& /*gap*/) {}
  /// Every scan, also between tests, in blocks; called after all other calls for the block.
  /// \param live  state after the last scan; idle between tests.
  virtual void observed(daq::ScanIndex /*first*/, std::span<const double> /*coefficient*/,
                        const detect::LiveState& /*live*/) {}
  /// The state of the bench has changed.
  virtual void bench_changed(BenchState /*state*/) {}
  /// A trouble that keeps the bench in its state was detected.
  /// \param duration_s  time in the state so far.
  virtual void bench_stays(BenchState /*state*/, double /*duration_s*/, BenchTrouble /*trouble*/) {}
};

}  // namespace stickslip::pipeline
