#include "core/pipeline/processor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/contract.hpp"

namespace stickslip::pipeline {
namespace {

SegmenterSettings complete(SegmenterSettings settings, const daq::Calibration& calibration,
                           const daq::RecordedFacts* recorded) {
  settings.step_coefficient = calibration.step_coefficient();
  if (recorded) settings.unloaded_level = recorded->unloaded_level;
  return settings;
}

daq::Note stall_at(daq::ScanIndex scan, double late_s) {
  return {daq::Note::Kind::kStall, scan, fmt::format("this scan was read {:.1f} s late", late_s)};
}

}  // namespace

Processor::Processor(const ProcessorSettings& settings, daq::Calibration calibration,
                     std::vector<Sink*> sinks)
    : settings_(settings),
      calibration_(std::move(calibration)),
      sinks_(std::move(sinks)),
      gaps_(settings.continues_at),
      segmenter_(complete(settings.segmenter, calibration_, settings.recorded.get())),
      bench_(settings.automatic),
      idle_(settings.analysis.scan_rate_Hz),
      number_(settings.first_test_number),
      next_scan_(settings.continues_at.value_or(0)),
      meter_(settings.analysis.scan_rate_Hz),
      picker_(settings.analysis.scan_rate_Hz) {
  settings_.analysis.step_coefficient = calibration_.step_coefficient();
  if (measures_speed()) settings_.analysis.speed_step_m_per_s = settings_.second->step();
  if (settings_.recorded) {
    const std::vector<daq::Note>& notes = settings_.recorded->notes;
    recorded_start_ = std::any_of(notes.begin(), notes.end(),
                                  [](const daq::Note& note) { return note.kind == daq::Note::Kind::kStart; });
  }
  static_cast<void>(happens(BenchEvent::kBoardBack));
}

void Processor::process(const daq::ScanBlock& block, daq::GapCause gap_cause, bool halted) {
  if (const std::optional<daq::Gap> gap = gaps_.observe(block, gap_cause, halted)) note_gap(*gap);
  scan_count_ += block.count;
  meter_.observe(block);
  watch_clocks(block);

  std::size_t not_handed_over = 0;  // First scan of the running test that the sinks have not seen.
  for (std::size_t i = 0; i < block.count; ++i) {
    const Scan scan{block.first + static_cast<daq::ScanIndex>(i), block.raw[i],
                    calibration_.coefficient(block.raw[i]), block.second[i]};
    const bool before = test_is_running();
    coefficients_[i] = scan.coefficient;
    next_scan_ = scan.index + 1;
    const std::optional<EndCause> over = observe(scan, block.stamp);
    if (!before && test_is_running()) not_handed_over = i + 1;
    if (over) {
      hand_over(block, not_handed_over, i + 1);
      end(next_scan_, *over);
    }
    follow_bench();
    watch_bench();
  }
  if (test_is_running()) {
    hand_over(block, not_handed_over, block.count);
    note_clocks(block);
    report_news();
  }
  const detect::LiveState now = live();
  for (Sink* sink : sinks_) sink->observed(block.first, std::span{coefficients_}.first(block.count), now);
}

std::optional<EndCause> Processor::observe(const Scan& scan, const daq::ClockStamp& stamp) {
  repeat_start(scan.index);
  const bool ready = segmenter_.ready();
  const Segmenter::Event event = segmenter_.observe(scan.index, scan.coefficient);
  if (test_is_running()) {
    analyse(scan);
    if (repeat_others(scan.index)) return stop_again();
    if (event == Segmenter::Event::kNone) return std::nullopt;
    static_cast<void>(happens(BenchEvent::kForceEnded));
    return event == Segmenter::Event::kUnloaded ? EndCause::kUnloaded : EndCause::kNoRelativeMotion;
  }
  // As the segmenter: what is left of the last test's force is no beginning of the next one.
  if (!ready) {
    // For a tare: a quiet force may be a zero that moved.
    if (segmenter_.quiet() && !segmenter_.ready()) {
      idle_.add(scan.index, scan.raw);
    } else {
      idle_.clear();
    }
    ++idle_scan_count_;
    if (event == Segmenter::Event::kPulledAgain) trouble(BenchTrouble::kPulledAgain);
    return std::nullopt;
  }
  waiting_.push_back(scan);
  if (event == Segmenter::Event::kTestStarts) {
    static_cast<void>(happens(BenchEvent::kForceRose));
    begin(scan.index, stamp);
    if (repeat_others(scan.index)) return stop_again();
  } else if (waiting_.size() > settings_.segmenter.pre_trigger_scans()) {
    if (event == Segmenter::Event::kNegative && trouble_ != BenchTrouble::kNegativeForce)
      trouble(BenchTrouble::kNegativeForce);
    const Scan& oldest = waiting_.front();
    // A bench that is not armed may be loaded by hand, which says nothing of its zero.
    if (bench_.state() == BenchState::kIdle && oldest.coefficient >= segmenter_.trigger()) {
      idle_.clear();
    } else {
      idle_.add(oldest.index, oldest.raw);
    }
    waiting_.pop_front();
    ++idle_scan_count_;
  }
  return std::nullopt;
}

void Processor::finish(EndCause cause) {
  if (test_is_running()) end(next_scan_, cause);
  discard_waiting();
  start_.reset();
  static_cast<void>(happens(BenchEvent::kBoardLost));
}

void Processor::lost_at_end(std::int64_t count) {
  STICKSLIP_EXPECTS(!test_is_running());
  if (count > 0) note_gap({next_scan_, count, false, daq::GapCause::kRingFull});
}

void Processor::discard_waiting() noexcept {
  idle_scan_count_ += static_cast<std::int64_t>(waiting_.size());
  waiting_.clear();
  idle_.clear();  // A self-check is about the scans right before a record.
}

void Processor::note_gap(daq::Gap gap) {
  if (settings_.recorded) {
    const auto known = std::find_if(
        settings_.recorded->gaps.begin(), settings_.recorded->gaps.end(),
        [&gap](const daq::Gap& old) { return old.first == gap.first && old.count == gap.count; });
    if (known != settings_.recorded->gaps.end()) gap = *known;
  }
  ++gap_count_;
  lost_scan_count_ += gap.count;
  if (gap.estimated) {
    meter_.restarted();
    if (const auto last = picker_.flush(); last && test_is_running()) note_anchor(*last);
  }
  if (!test_is_running()) {
    // What was before a gap cannot be shown to belong to the coming test.
    discard_waiting();
    for (Sink* sink : sinks_) sink->gap_between_tests(gap);
    return;
  }
  test_gaps_.push_back(gap);
  analysis_->gap(gap.first, gap.count, gap.estimated);
  for (Sink* sink : sinks_) sink->gap(gap);
}

void Processor::watch_clocks(const daq::ScanBlock& block) {
  if (settings_.recorded || block.count == 0) return;
  // Where the clock is not the machine's own, being late means nothing: the source waits for its reader.
  const auto news =
      watch_.observe(block.stamp, settings_.clock_is_real ? meter_.lateness_ns(block) : std::nullopt);
  if (news.stall_s) tell_clocks(stall_at(block.first, *news.stall_s));
  if (news.step_s) {
    tell_clocks({daq::Note::Kind::kStep, block.first,
                 fmt::format("the date went {:.1f} s {}: the clock was set", std::abs(*news.step_s),
                             *news.step_s > 0.0 ? "ahead" : "back")});
  }
}

void Processor::tell_clocks(const daq::Note& note) {
  if (test_is_running()) return tell(note);
  for (Sink* sink : sinks_) sink->note_between_tests(note);
}

void Processor::begin(daq::ScanIndex trigger, daq::ClockStamp stamp) {
  // Late reading makes no test later; to the scan as well as the block's last one says.
  stamp.monotonic_ns -= std::llround(watch_.late_ns());
  stamp.realtime_ns -= std::llround(watch_.late_ns());
  analysis_.emplace(settings_.analysis);
  trigger_ = trigger;
  static_cast<void>(picker_.flush());
  anchors_.clear();
  test_gaps_.clear();
  read_latency_.reset();
  const bool by_command = start_.has_value() || recorded_start_;
  const TestStart start{number_,    waiting_.front().index,     trigger, stamp, self_check(),
                        by_command, segmenter_.unloaded_level()};
  self_check_ = start.self_check;
  facts_ = {.scan_rate_Hz = settings_.analysis.scan_rate_Hz,
            .start_realtime_ns = stamp.realtime_ns,
            .calibration = settings_.calibration,
            .sled_mass_kg = settings_.analysis.tester.sled_mass_kg,
            .normal_load_N = calibration_.normal_load_N(),
            .was_cut_out = true,
            .self_check = self_check_.get(),
            .level_before = start.unloaded_level};
  if (settings_.recorded) {
    // The date of the measurement, not that of its replay.
    facts_.start_realtime_ns.reset();
    if (!settings_.recorded->anchors.empty())
      facts_.start_realtime_ns = settings_.recorded->anchors.front().realtime_ns;
  }
  idle_.clear();
  std::vector<double> raw;
  raw.reserve(waiting_.size());
  std::vector<std::int32_t> second;
  for (const Scan& scan : waiting_) {
    raw.push_back(scan.raw);
    if (settings_.second) second.push_back(scan.second);
    analyse(scan);
  }
  waiting_.clear();
  for (Sink* sink : sinks_) {
    sink->test_began(start);
    sink->scans(start.first, raw, second, stamp);
  }
  for (std::string& text : for_later_) tell({daq::Note::Kind::kBench, start.first, std::move(text)});
  for_later_.clear();
  if (watch_.late_ns() > 0.0) tell(stall_at(trigger, 1e-9 * watch_.late_ns()));
  if (start_) {
    start_->scan = trigger;
    tell(*std::exchange(start_, std::nullopt));
  }
}

std::shared_ptr<const daq::SelfCheck> Processor::self_check() const {
  if (settings_.recorded && settings_.recorded->self_check) return settings_.recorded->self_check;
  const auto rate = settings_.clock_is_real ? meter_.estimate() : std::nullopt;
  const std::optional<daq::SelfCheck> check = idle_.check(calibration_, rate);
  return check ? std::make_shared<const daq::SelfCheck>(*check) : nullptr;
}

void Processor::analyse(const Scan& scan) {
  if (measures_speed()) analysis_->speed(settings_.second->value(scan.second));
  const bool saturated = calibration_.saturated(scan.raw);
  ++facts_.scan_count;
  if (saturated) ++facts_.saturated_count;
  analysis_->add(scan.index, scan.coefficient, saturated);
}

void Processor::end(daq::ScanIndex end, EndCause cause) {
  analysis_->end_live();
  report_news();
  finish_clocks(end);
  TestEnd ended;
  ended.number = number_++;
  ended.end = end;
  ended.cause = cause;
  ended.results = analysis_->finish();
  if (cause == EndCause::kUnloaded) ended.unloaded_level = segmenter_.level_after();
  facts_.anchors = anchors_;
  facts_.gaps = test_gaps_;
  facts_.level_after = ended.unloaded_level;
  add_facts(facts_, ended.results);
  ended.cycles = analysis_->cycles();
  ended.spikes = analysis_->spikes();
  ended.spike_coefficients = analysis_->spike_coefficients();
  ended.read_latency = settings_.recorded ? settings_.recorded->read_latency : read_latency_;
  analysis_.reset();
  for (Sink* sink : sinks_) sink->test_ended(ended);
}

void Processor::note_clocks(const daq::ScanBlock& block) {
  if (!settings_.clock_is_real || settings_.recorded) return;
  if (const auto anchor = picker_.observe(block)) note_anchor(*anchor);
  if (const auto late_ns = meter_.lateness_ns(block)) {
    if (!read_latency_) read_latency_.emplace();
    read_latency_->add(*late_ns);
  }
}

void Processor::note_anchor(const daq::ClockAnchor& anchor) {
  anchors_.push_back(anchor);
  for (Sink* sink : sinks_) sink->anchor(anchor);
}

void Processor::finish_clocks(daq::ScanIndex end) {
  if (settings_.recorded) {
    for (const daq::ClockAnchor& anchor : settings_.recorded->anchors) {
      if (anchor.scan >= trigger_ && anchor.scan < end) note_anchor(anchor);
    }
  } else if (const auto last = picker_.flush()) {
    note_anchor(*last);
  }
}

void Processor::hand_over(const daq::ScanBlock& block, std::size_t from, std::size_t to) {
  if (from >= to) return;
  const daq::ScanIndex first = block.first + static_cast<daq::ScanIndex>(from);
  const std::span<const double> raw = block.scans().subspan(from, to - from);
  std::span<const std::int32_t> second;
  if (settings_.second) second = std::span{block.second}.subspan(from, to - from);
  for (Sink* sink : sinks_) sink->scans(first, raw, second, block.stamp);
}

void Processor::report_news() {
  for (const detect::FallBegun& fall : analysis_->take_new_falls()) {
    for (Sink* sink : sinks_) sink->fall(fall);
  }
  for (const detect::Cycle& cycle : analysis_->take_new_cycles()) {
    for (Sink* sink : sinks_) sink->cycle(cycle);
  }
}

}  // namespace stickslip::pipeline
