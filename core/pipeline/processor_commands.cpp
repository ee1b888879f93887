// What people tell the bench to do: each takes effect at a scan, so that a replay of the record does it
// again.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/pipeline/processor.hpp"

namespace stickslip::pipeline {
namespace {

/// Most notes from before a test that its record contains; older ones are dropped.
constexpr std::size_t kMostForLater = 16;

}  // namespace

CommandReport Processor::arm(const std::string& who) {
  const bool armed_already = bench_.state() == BenchState::kArmed;
  const std::string_view refusal = happens(BenchEvent::kArm);
  if (refusal.empty() && !armed_already) {
    if (segmenter_.arm()) discard_waiting();
    note_for_later(fmt::format("armed at scan {}, by {}", next_scan_, who));
  }
  return {std::string{refusal}, bench_.state(), number_, next_scan_};
}

CommandReport Processor::start(const std::string& who) {
  const std::string_view refusal = happens(BenchEvent::kStart);
  if (refusal.empty()) {
    segmenter_.start();
    start_ = daq::Note{daq::Note::Kind::kStart, next_scan_, who};
  }
  return {std::string{refusal}, bench_.state(), number_, next_scan_};
}

CommandReport Processor::stop(const std::string& who) {
  const std::int64_t test = number_;
  const daq::ScanIndex last = next_scan_ - 1;
  const bool running = test_is_running();
  const std::string_view refusal = happens(BenchEvent::kStop);
  if (!refusal.empty()) return {std::string{refusal}, bench_.state(), test, last};
  start_.reset();
  segmenter_.stop();
  if (running) {
    tell({daq::Note::Kind::kStop, last, who});
    end(next_scan_, EndCause::kCommand);
  }
  follow_bench();
  return {{}, bench_.state(), test, last};
}

CommandReport Processor::mark(const std::string& text) {
  CommandReport report{{}, bench_.state(), number_, next_scan_ - 1};
  if (test_is_running()) {
    tell({daq::Note::Kind::kMark, report.scan, text});
  } else {
    report.refusal = "no test is running: there is no record to mark";
  }
  return report;
}

TareReport Processor::tare(const std::string& who) {
  TareReport report;
  report.state = bench_.state();
  report.test = number_;
  report.scan = next_scan_;
  const auto refuse = [&report](std::string why) {
    report.refusal = std::move(why);
    return report;
  };
  if (test_runs(bench_.state())) return refuse("a test is running; stop it first");
  if (bench_.state() == BenchState::kDegraded) {
    return refuse(std::string{step(bench_.state(), BenchEvent::kStart, settings_.automatic).refusal});
  }
  if (!calibration_.measures_voltage())
    return refuse("the readings are no voltages: there is no zero to set");
  const std::optional<daq::SelfCheck> check = idle_.check(calibration_, {});
  if ((!check || !check->zero_N) && bench_.state() == BenchState::kFinishing) {
    return refuse("the force is not quiet; leave the unloaded sled at rest for a second, then tare again");
  }
  if (!check || !check->zero_N) {
    return refuse(fmt::format("there are only {} scans of the unloaded bench so far, {} are needed",
                              check ? check->raw.size() : 0, kFewestIdleScans));
  }
  const double largest_N = std::max(settings_.segmenter.start_coefficient, UnloadedLevel::kFarthest) *
                           calibration_.normal_load_N();
  if (std::abs(*check->zero_N) >= largest_N) {
    // A calibration needs an idle bench, which this one is not before its force is gone.
    const bool finishing = bench_.state() == BenchState::kFinishing;
    return refuse(
        fmt::format("the cell reads {:.2f} ({:.3g} N), and {:.2f} ({:.3g} N) or more is a load: take the "
                    "sled off and tare "
                    "again; if nothing pulls, {}",
                    *check->zero_N / calibration_.normal_load_N(), *check->zero_N,
                    largest_N / calibration_.normal_load_N(), largest_N,
                    finishing ? "correct [tester] load_cell_zero and restart the daemon" : "calibrate"));
  }
  if (check->saturated_count.value_or(0) > 0) return refuse("the converter is at a rail");
  const daq::LoadCell before = calibration_.load_cell();
  report.moved_N = *check->zero_N;
  report.zero_V = before.zero_V + report.moved_N / before.gain_N_per_V;
  report.zero_standard_error_V = check->zero_standard_error_N.value_or(0.0) / std::abs(before.gain_N_per_V);
  report.scan_count = check->raw.size();
  calibration_ = calibration_.with_zero(report.zero_V);
  std::vector<double> kept;
  for (Scan& scan : waiting_) {
    scan.coefficient = calibration_.coefficient(scan.raw);
    kept.push_back(scan.coefficient);
  }
  if (segmenter_.tared(kept)) discard_waiting();
  follow_bench();
  report.state = bench_.state();
  note_for_later(fmt::format("zero of the load cell set from {:.6g} V to {:.6g} V at scan {}, by {}",
                             before.zero_V, report.zero_V, next_scan_, who));
  return report;
}

CommandReport Processor::recalibrate(daq::Calibration calibration, const CalibrationInUse& in_use,
                                     const std::string& who) {
  CommandReport report{{}, bench_.state(), number_, next_scan_};
  if (bench_.state() != BenchState::kIdle) {
    report.refusal = fmt::format("the bench is {}; a new calibration needs it idle", name(bench_.state()));
    return report;
  }
  calibration_ = std::move(calibration);
  const double step = calibration_.step_coefficient();
  settings_.analysis.step_coefficient = step;
  settings_.segmenter.step_coefficient = step;
  settings_.calibration = in_use;
  // What was kept for the next test was weighed otherwise: a replay, which knows one calibration, could not
  // tell.
  segmenter_ = Segmenter{settings_.segmenter};
  segmenter_.trigger_by_force(false);
  discard_waiting();
  const daq::LoadCell& cell = calibration_.load_cell();
  note_for_later(fmt::format("load cell calibrated: {:.8g} N/V, zero {:.6g} V, from scan {}, by {}",
                             cell.gain_N_per_V, cell.zero_V, next_scan_, who));
  return report;
}

void Processor::note_for_later(std::string text) {
  if (for_later_.size() == kMostForLater) for_later_.erase(for_later_.begin());
  for_later_.push_back(std::move(text));
}

void Processor::tell(const daq::Note& note) {
  for (Sink* sink : sinks_) sink->note(note);
}

std::string_view Processor::happens(BenchEvent event) {
  const BenchState before = bench_.state();
  const std::string_view refusal = bench_.observe(event);
  const BenchState state = bench_.state();
  segmenter_.trigger_by_force(state == BenchState::kArmed && !recorded_start_);
  if (state != before) {
    bench_scans_ = 0;
    trouble_ = BenchTrouble::kNone;
    for (Sink* sink : sinks_) sink->bench_changed(state);
  }
  return refusal;
}

void Processor::follow_bench() {
  // What is no command is never refused.
  if (bench_.state() == BenchState::kLoading && analysis_ &&
      analysis_->live().phase >= detect::Phase::kFirstSlip) {
    static_cast<void>(happens(BenchEvent::kSlipped));
  }
  if (bench_.state() == BenchState::kFinishing && segmenter_.ready()) {
    static_cast<void>(happens(BenchEvent::kUnloaded));
  }
}

void Processor::watch_bench() {
  ++bench_scans_;
  const Patience given = patience(bench_.state(), settings_.automatic);
  if (given.trouble == BenchTrouble::kNone) return;
  if (bench_scans_ == std::llround(given.longest_s * settings_.analysis.scan_rate_Hz)) trouble(given.trouble);
}

void Processor::trouble(BenchTrouble trouble) {
  trouble_ = trouble;
  const double duration_s = static_cast<double>(bench_scans_) / settings_.analysis.scan_rate_Hz;
  for (Sink* sink : sinks_) sink->bench_stays(bench_.state(), duration_s, trouble);
}

void Processor::repeat_start(daq::ScanIndex index) {
  if (!settings_.recorded) return;
  const std::vector<daq::Note>& notes = settings_.recorded->notes;
  const bool starts = std::any_of(notes.begin(), notes.end(), [index](const daq::Note& note) {
    return note.kind == daq::Note::Kind::kStart && note.scan == index;
  });
  if (starts && happens(BenchEvent::kStart).empty()) segmenter_.start();
}

EndCause Processor::stop_again() {
  static_cast<void>(happens(BenchEvent::kStop));
  segmenter_.stop();
  return EndCause::kCommand;
}

bool Processor::repeat_others(daq::ScanIndex index) {
  if (!settings_.recorded) return false;
  const std::vector<daq::Note>& notes = settings_.recorded->notes;
  bool stops = false;
  while (next_recorded_note_ < notes.size() && notes[next_recorded_note_].scan <= index) {
    const daq::Note& note = notes[next_recorded_note_++];
    tell(note);
    stops = stops || note.kind == daq::Note::Kind::kStop;
  }
  return stops;
}

}  // namespace stickslip::pipeline
