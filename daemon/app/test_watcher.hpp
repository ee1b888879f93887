/// \file
/// Sink that enters tests into the TestLog and reports events of tests and bench.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "core/model/truth.hpp"
#include "core/pipeline/sink.hpp"
#include "daemon/types/event_receiver.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::app {

class TestWatcher final : public pipeline::Sink {
 public:
  /// \param current  called on the processing thread with the number of the running test, or nothing when it
  /// has ended. \param rests    called on the processing thread when the bench comes to rest, before the next
  /// test begins.
  TestWatcher(daemon::TestLog& tests, daemon::EventReceiver& events,
              std::function<void(std::optional<std::int64_t>)> current, std::function<void()> rests)
      : tests_(tests), events_(events), current_(std::move(current)), rests_(std::move(rests)) {}

  /// Call it only between sessions. \param truth  null if unknown. \param first_slip_counts  as
  /// analysis::SkippedCorrections::first_slip.
  void use(const model::TruthSource* truth, bool first_slip_counts) {
    truth_ = truth;
    first_slip_counts_ = first_slip_counts;
  }

  void test_began(const pipeline::TestStart& start) override {
    first_ = start.first;
    number_ = start.number;
    events_.test_began(start);
    current_(start.number);
  }

  void bench_changed(pipeline::BenchState state) override {
    if (pipeline::rests(state)) rests_();
  }
  void bench_stays(pipeline::BenchState state, double duration_s, pipeline::BenchTrouble trouble) override {
    events_.bench_stays(pipeline::name(state), duration_s, pipeline::words(trouble));
  }
  void gap(const daq::Gap& gap) override { events_.gap_seen(gap, number_); }
  void gap_between_tests(const daq::Gap& gap) override { events_.gap_seen(gap, std::nullopt); }
  void note(const daq::Note& note) override {
    using Kind = daq::Note::Kind;
    if (note.kind == Kind::kStall || note.kind == Kind::kStep) events_.clock_noted(note, number_);
  }
  void note_between_tests(const daq::Note& note) override { events_.clock_noted(note, std::nullopt); }

  void test_ended(const pipeline::TestEnd& end) override {
    daemon::TestSummary summary;
    summary.number = end.number;
    summary.first = first_;
    summary.end = end.end;
    summary.cause = end.cause;
    summary.results = end.results;
    summary.slips = analysis::slip_sums(end.cycles, first_slip_counts_);
    if (truth_ != nullptr) summary.truth = truth_->truth(first_, end.end);
    tests_.add(std::move(summary));
    events_.test_ended(end);
    current_(std::nullopt);
  }

 private:
  daemon::TestLog& tests_;
  daemon::EventReceiver& events_;
  std::function<void(std::optional<std::int64_t>)> current_;
  std::function<void()> rests_;
  const model::TruthSource* truth_ = nullptr;
  bool first_slip_counts_ = false;
  daq::ScanIndex first_ = 0;  ///< First scan of the running test.
  std::int64_t number_ = 0;
};

}  // namespace stickslip::app
