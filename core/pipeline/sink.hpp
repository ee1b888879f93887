/// \file
/// Where the walk of a scan ends: record, live page, table, broker are sinks.
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
#include "core/daq/self_check.hpp"
#include "core/detect/cycle.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {

/// A test began. Its scans follow, pre-trigger scans first.
struct TestStart {
  std::int64_t number = 0;                           ///< Since the start of the program, from 1.
  daq::ScanIndex first = 0;                          ///< First scan that belongs to the test's record.
  daq::ScanIndex trigger = 0;                        ///< Scan that began it: the force or a command did.
  daq::ClockStamp stamp;                             ///< When the trigger was seen; less a stall before.
  std::shared_ptr<const daq::SelfCheck> self_check;  ///< Null if there was nothing to look at.
  bool by_command = false;
  /// What the unloaded cell read, as a coefficient; absent where no quiet scans told.
  std::optional<double> unloaded_level = {};
};

/// Why a test is over.
enum class EndCause {
  kUnloaded,          ///< The force went back to zero.
  kNoRelativeMotion,  ///< The belt stopped; the coupling stays stretched.
  kEndOfInput,        ///< The source has no more scans.
  kCommand,           ///< Somebody commanded it.
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

struct TestEnd {
  std::int64_t number = 0;
  daq::ScanIndex end = 0;  ///< One past the last scan of the record.
  EndCause cause = EndCause::kUnloaded;
  /// What the unloaded cell read at the end; absent unless the test ended by unloading, and quietly.
  std::optional<double> unloaded_level = {};
  analysis::TestResults results;
  base::LongColumn<detect::Cycle> cycles;             ///< Final values, after the whole-test estimate.
  std::vector<daq::ScanIndex> spikes;                 ///< Scans replaced for the detector.
  std::vector<double> spike_coefficients;             ///< What was measured in each of them.
  std::optional<daq::LatencyHistogram> read_latency;  ///< Of its blocks; none where no clock could tell.
};

/// Called from the processing thread, in order: began, (scans | gap | anchor | fall | cycle | note)*, ended.
/// Must not throw; may block only if it must never lose data (the record), and then stalls the walk.
class Sink {
 public:
  virtual ~Sink() = default;

  virtual void test_began(const TestStart& /*start*/) {}
  /// Raw scans of the running test, consecutive, oldest first.
  /// \param second  codes of the second channel: as many, or none if there is no such channel.
  virtual void scans(daq::ScanIndex /*first*/, std::span<const double> /*raw*/,
                     std::span<const std::int32_t> /*second*/, const daq::ClockStamp& /*stamp*/) {}
  virtual void gap(const daq::Gap& /*gap*/) {}
  /// The clocks at a scan of the running test; rising, and after the scan itself.
  virtual void anchor(const daq::ClockAnchor& /*anchor*/) {}
  /// As soon as it is seen: perhaps a slip, of which the cycle follows.
  virtual void fall(const detect::FallBegun& /*fall*/) {}
  /// As soon as it is known, before the whole-test estimate refines it.
  virtual void cycle(const detect::Cycle& /*cycle*/) {}
  /// What a person did or the computer suffered, at a scan of the running test; in no order with its scans.
  virtual void note(const daq::Note& /*note*/) {}
  virtual void test_ended(const TestEnd& /*end*/) {}
  /// What the computer suffered while no test was running.
  virtual void note_between_tests(const daq::Note& /*note*/) {}
  /// Scans lost while no test was running.
  virtual void gap_between_tests(const daq::Gap& /*gap*/) {}
  /// Each scan, whether a test runs or not, in blocks; after all else that the block brought.
  /// \param live  after the last of them; idle between tests.
  virtual void observed(daq::ScanIndex /*first*/, std::span<const double> /*coefficient*/,
                        const detect::LiveState& /*live*/) {}
  /// The bench is in another state.
  virtual void bench_changed(BenchState /*state*/) {}
  /// Something keeps it in its state. \param duration_s  so far.
  virtual void bench_stays(BenchState /*state*/, double /*duration_s*/, BenchTrouble /*trouble*/) {}
};

}  // namespace stickslip::pipeline
