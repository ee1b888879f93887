// Commands at any moment, to the whole walk: the machine, the segmenter and the record stay together, and a
// replay of each record gives it again.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/pipeline/processor.hpp"

namespace stickslip::pipeline {
namespace {

constexpr double kRate_Hz = 100.0;

struct RecordedTest {
  TestStart start;
  std::vector<double> raw;
  std::vector<daq::Note> notes;
  TestEnd end;
};

/// Keeps the tests as records would, and looks whether the order is right.
class Recorder final : public Sink {
 public:
  void test_began(const TestStart& start) override {
    ++running;
    tests.push_back({start, {}, {}, {}});
  }
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t>,
             const daq::ClockStamp&) override {
    RecordedTest& test = tests.back();
    contiguous = contiguous && first == test.start.first + static_cast<daq::ScanIndex>(test.raw.size());
    test.raw.insert(test.raw.end(), raw.begin(), raw.end());
  }
  void note(const daq::Note& note) override { tests.back().notes.push_back(note); }
  void test_ended(const TestEnd& end) override {
    --running;
    tests.back().end = end;
  }
  void bench_changed(BenchState state) override { told = state; }
  void bench_stays(BenchState state, double, BenchTrouble trouble) override {
    stays.push_back(state);
    troubles.push_back(trouble);
  }
  void observed(daq::ScanIndex, std::span<const double> coefficient, const detect::LiveState&) override {
    observed_count += coefficient.size();
  }

  std::vector<RecordedTest> tests;
  int running = 0;
  bool contiguous = true;
  std::size_t observed_count = 0;
  BenchState told = BenchState::kDegraded;
  std::vector<BenchState> stays;
  std::vector<BenchTrouble> troubles;
};

ProcessorSettings settings_of(bool automatic) {
  ProcessorSettings settings;
  settings.segmenter.scan_rate_Hz = kRate_Hz;
  settings.segmenter.start_dwell_s = 0.02;
  settings.segmenter.pre_trigger_s = 0.2;
  settings.segmenter.unload_dwell_s = 0.1;
  settings.analysis.scan_rate_Hz = kRate_Hz;
  settings.automatic = automatic;
  settings.clock_is_real = false;  // The stamps here say nothing, and a replay takes the clocks of then.
  return settings;
}

daq::Calibration coefficients() {
  daq::BoardInfo board;
  board.quantity = daq::RawQuantity::kCoefficient;
  return {board, {}, 1.0};
}

/// Rest, pulls with slips, and pulls that stand still, one after the other.
std::vector<double> any_course() {
  std::vector<double> force;
  for (int pull = *rc::gen::inRange(1, 4); pull > 0; --pull) {
    for (int k = *rc::gen::inRange(0, 60); k > 0; --k) force.push_back(0.0);
    const int scans = *rc::gen::inRange(5, 150);
    const double period = *rc::gen::inRange(8, 30);
    for (int k = 0; k < scans; ++k) {
      const double phase = std::fmod(k, period) / period;
      force.push_back(0.3 + (phase < 0.8 ? 0.1 * phase : 0.4 * (1.0 - phase)));
    }
    for (int k = *rc::gen::inRange(0, 60); k > 0; --k) force.push_back(*rc::gen::element(0.0, 0.3));
  }
  return force;
}

bool same(const analysis::TestResults& a, const analysis::TestResults& b) {
  bool equal = a.regime == b.regime;
  analysis::TestResults other = b;
  analysis::TestResults own = a;
  std::vector<std::optional<double>> values;
  analysis::for_each_result(own, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
    values.push_back(estimate.value);
  });
  std::size_t at = 0;
  analysis::for_each_result(other, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
    equal = equal && values[at++] == estimate.value;
  });
  return equal;
}

/// \param first  index of values[0].
void feed(Processor& processor, const std::vector<double>& values, daq::ScanIndex first, std::size_t most) {
  for (std::size_t at = 0; at < values.size();) {
    daq::ScanBlock block;
    block.first = first + static_cast<daq::ScanIndex>(at);
    while (at < values.size() && block.count < most) block.raw[block.count++] = values[at++];
    processor.process(block, daq::GapCause::kRingFull);
  }
}

void replay_gives(const RecordedTest& test, bool automatic) {
  ProcessorSettings settings = settings_of(automatic);
  auto recorded = std::make_shared<daq::RecordedFacts>();
  recorded->notes = test.notes;
  recorded->self_check = test.start.self_check;
  recorded->unloaded_level = test.start.unloaded_level;
  settings.recorded = recorded;
  Recorder again;
  Processor processor{settings, coefficients(), {&again}};
  feed(processor, test.raw, test.start.first, static_cast<std::size_t>(*rc::gen::inRange(1, 65)));
  processor.finish(EndCause::kEndOfInput);
  RC_ASSERT(again.tests.size() == 1U);
  const RecordedTest& other = again.tests.front();
  RC_ASSERT(other.start.first == test.start.first);
  RC_ASSERT(other.start.trigger == test.start.trigger);
  RC_ASSERT(other.start.by_command == test.start.by_command);
  RC_ASSERT(other.raw == test.raw);
  RC_ASSERT(other.notes == test.notes);
  RC_ASSERT(other.end.end == test.end.end);
  RC_ASSERT(other.end.cause == test.end.cause || test.end.cause == EndCause::kBoardMissing);
  RC_ASSERT(other.end.cause != test.end.cause || other.end.unloaded_level == test.end.unloaded_level);
  RC_ASSERT(same(other.end.results, test.end.results));
}

RC_GTEST_PROP(Commands, KeepMachineSegmenterAndRecordTogether, (bool automatic)) {
  Recorder record;
  Processor processor{settings_of(automatic), coefficients(), {&record}};
  const std::vector<double> force = any_course();
  const auto most = static_cast<std::size_t>(*rc::gen::inRange(1, 65));
  daq::ScanIndex index = 0;
  for (std::size_t at = 0; at < force.size();) {
    if (*rc::gen::inRange(0, 4) == 0) {
      const BenchState before = processor.bench();
      CommandReport report;
      switch (*rc::gen::inRange(0, 5)) {
        case 0:
          report = processor.arm("a");
          break;
        case 1:
          report = processor.start("b");
          break;
        case 2:
          report = processor.stop("c");
          break;
        case 3:
          report = processor.mark("d");
          break;
        default: {
          const TareReport tared = processor.tare("e");
          report.refusal = tared.refusal;
          report.state = tared.state;
        } break;
      }
      RC_ASSERT(report.state == processor.bench());
      if (!report.refusal.empty()) RC_ASSERT(processor.bench() == before);
    }
    const std::size_t count = std::min(most, force.size() - at);
    feed(processor,
         {force.begin() + static_cast<std::ptrdiff_t>(at),
          force.begin() + static_cast<std::ptrdiff_t>(at + count)},
         index, most);
    at += count;
    index += static_cast<daq::ScanIndex>(count);
    // After each scan that came: a test is recorded exactly while the machine says so.
    RC_ASSERT(processor.test_is_running() == test_runs(processor.bench()));
    RC_ASSERT(record.running == (processor.test_is_running() ? 1 : 0));
    RC_ASSERT(record.told == processor.bench());
  }
  RC_ASSERT(record.observed_count == force.size());
  processor.finish(EndCause::kBoardMissing);
  RC_ASSERT(processor.bench() == BenchState::kDegraded);
  RC_ASSERT(record.running == 0);
  RC_ASSERT(record.contiguous);
  // The account closes: each scan is in a record or was idle.
  std::size_t recorded = 0;
  for (const RecordedTest& test : record.tests) recorded += test.raw.size();
  RC_ASSERT(recorded + static_cast<std::size_t>(processor.idle_scan_count()) == force.size());
  for (const RecordedTest& test : record.tests) {
    RC_ASSERT(test.end.end == test.start.first + static_cast<daq::ScanIndex>(test.raw.size()));
    for (const daq::Note& note : test.notes) {
      RC_ASSERT(note.scan >= test.start.first);
      RC_ASSERT(note.scan < test.end.end);
      RC_ASSERT(daq::parse_note(note.scan, daq::to_text(note)) == note);
    }
    // A test begun by force replays in the automatic mode, one begun by a command in either.
    replay_gives(test, test.start.by_command ? *rc::gen::arbitrary<bool>() : true);
  }
}

TEST(Commands, ATestBegunByHandWaitsForItsForceAndEndsWithIt) {
  Recorder record;
  Processor processor{settings_of(false), coefficients(), {&record}};
  feed(processor, std::vector<double>(100, 0.0), 0, 10);
  EXPECT_EQ(processor.bench(), BenchState::kIdle);
  feed(processor, std::vector<double>(50, 0.3), 100, 10);
  EXPECT_TRUE(record.tests.empty()) << "nobody armed it";
  feed(processor, std::vector<double>(50, 0.0), 150, 10);
  const CommandReport started = processor.start("ada");
  EXPECT_EQ(started.refusal, "");
  EXPECT_EQ(started.scan, 200);
  EXPECT_EQ(started.test, 1);
  feed(processor, std::vector<double>(100, 0.0), 200, 10);  // Longer than the dwell: no end yet.
  EXPECT_EQ(processor.bench(), BenchState::kLoading);
  feed(processor, std::vector<double>(100, 0.3), 300, 10);
  feed(processor, std::vector<double>(100, 0.0), 400, 10);
  ASSERT_EQ(record.tests.size(), 1U);
  const RecordedTest& test = record.tests[0];
  EXPECT_EQ(test.start.trigger, 200);
  EXPECT_EQ(test.start.first, 200 - 20);
  EXPECT_TRUE(test.start.by_command);
  EXPECT_EQ(test.end.cause, EndCause::kUnloaded);
  EXPECT_EQ(test.end.end, 400 + 10);
  EXPECT_EQ(test.notes, (std::vector<daq::Note>{{daq::Note::Kind::kStart, 200, "ada"}}));
  EXPECT_EQ(processor.bench(), BenchState::kIdle);
}

TEST(Commands, AnArmedBenchTakesOneTestByForceAndIsIdleThen) {
  Recorder record;
  Processor processor{settings_of(false), coefficients(), {&record}};
  feed(processor, std::vector<double>(100, 0.0), 0, 10);
  EXPECT_EQ(processor.arm("ada").refusal, "");
  EXPECT_EQ(processor.arm("ada").refusal, "") << "said twice is said once";
  std::vector<double> pulls;
  for (int k = 0; k < 2; ++k) {
    pulls.insert(pulls.end(), 50, 0.3);
    pulls.insert(pulls.end(), 50, 0.0);
  }
  feed(processor, pulls, 100, 10);
  ASSERT_EQ(record.tests.size(), 1U);
  EXPECT_EQ(record.tests[0].start.trigger, 101);
  EXPECT_EQ(daq::to_text(record.tests[0].notes.at(0)), "bench: armed at scan 100, by ada");
  EXPECT_EQ(processor.bench(), BenchState::kIdle);
}

// The zero may be anywhere the documents allow, and move by half the trigger while nobody looks.
RC_GTEST_PROP(Commands, EachPullHasItsRecordWhateverTheZero, ()) {
  double zero = 1e-3 * *rc::gen::inRange(-70, 71);
  std::vector<double> force(*rc::gen::inRange<std::size_t>(100, 200), zero);
  const int pulls = *rc::gen::inRange(1, 4);
  for (int pull = 0; pull < pulls; ++pull) {
    const int scans = *rc::gen::inRange(50, 150);
    for (int k = 0; k < scans; ++k) force.push_back(zero + 0.3 + 0.1 * std::fmod(k, 20.0) / 20.0);
    zero = std::clamp(zero + 1e-3 * *rc::gen::inRange(-30, 31), -0.07, 0.07);
    force.insert(force.end(), *rc::gen::inRange<std::size_t>(100, 200), zero);
  }
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  feed(processor, force, 0, static_cast<std::size_t>(*rc::gen::inRange(1, 65)));
  RC_ASSERT(processor.bench() == BenchState::kArmed);
  processor.finish(EndCause::kEndOfInput);
  RC_ASSERT(record.tests.size() == static_cast<std::size_t>(pulls));
  for (const RecordedTest& test : record.tests) replay_gives(test, true);
}

/// Pulls above a zero that creeps, steps and is noisy; `pulls` holds where each stands at its full height.
struct Day {
  std::vector<double> force;
  std::vector<std::pair<std::size_t, std::size_t>> pulls;
};

Day any_day() {
  Day day;
  std::mt19937_64 engine{static_cast<std::uint64_t>(*rc::gen::inRange(0, 1'000'000))};
  std::normal_distribution<double> noise{0.0, 1e-4 * *rc::gen::inRange(0, 21)};
  double zero = 1e-3 * *rc::gen::inRange(-60, 61);
  double creep = 1e-5 * *rc::gen::inRange(-10, 11);
  const auto push = [&](double value) {
    zero = std::clamp(zero + creep, -0.09, 0.09);
    day.force.push_back(zero + value + noise(engine));
  };
  const auto rest = [&](int scans) {
    while (scans-- > 0) push(0.0);
  };
  rest(*rc::gen::inRange(100, 200));
  for (int pull = *rc::gen::inRange(1, 6); pull > 0; --pull) {
    const int scans = *rc::gen::inRange(40, 150);
    const double period = *rc::gen::inRange(8, 30);
    const std::size_t first = day.force.size();
    for (int k = 0; k < 10; ++k) push(0.03 * k);
    for (int k = 0; k < scans; ++k) {
      const double phase = std::fmod(k, period) / period;
      push(0.3 + (phase < 0.8 ? 0.1 * phase : 0.4 * (1.0 - phase)));
    }
    day.pulls.emplace_back(first + 10, day.force.size());
    // The belt stands, and the coupling stays stretched.
    for (int k = *rc::gen::element(0, 0, 100); k > 0; --k) push(0.36);
    if (*rc::gen::arbitrary<bool>()) zero = std::clamp(zero + 1e-3 * *rc::gen::inRange(-40, 41), -0.09, 0.09);
    creep = 1e-5 * *rc::gen::inRange(-10, 11);
    rest(*rc::gen::inRange(30, 200));  // From 0.3 s on.
  }
  return day;
}

// Each pull is in a record, or something has said why not.
RC_GTEST_PROP(Commands, NoPullIsLostInSilence, ()) {
  const Day day = any_day();
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  feed(processor, day.force, 0, static_cast<std::size_t>(*rc::gen::inRange(1, 65)));
  processor.finish(EndCause::kEndOfInput);
  // Of pulls in a row that are missing the first is told.
  std::size_t missing = 0;
  bool before = true;
  for (const auto& pull : day.pulls) {
    const bool recorded =
        std::any_of(record.tests.begin(), record.tests.end(), [&pull](const RecordedTest& test) {
          return test.start.first <= static_cast<daq::ScanIndex>(pull.first) &&
                 test.end.end >= static_cast<daq::ScanIndex>((pull.first + pull.second) / 2);
        });
    if (before && !recorded) ++missing;
    before = recorded;
  }
  const auto told = static_cast<std::size_t>(
      std::count(record.troubles.begin(), record.troubles.end(), BenchTrouble::kPulledAgain));
  RC_CLASSIFY(missing > 0, "a pull is in no record, and that is told");
  RC_ASSERT(missing <= told);
  for (const RecordedTest& test : record.tests) replay_gives(test, true);
}

TEST(Commands, AForceOfTheWrongSignIsToldUntilTheNextTest) {
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  feed(processor, std::vector<double>(300, 0.0), 0, 10);
  for (int pull = 0; pull < 2; ++pull) {
    feed(processor, std::vector<double>(200, -0.3), 300 + 500 * pull, 10);
    feed(processor, std::vector<double>(300, 0.0), 500 + 500 * pull, 10);
  }
  EXPECT_EQ(record.troubles, std::vector{BenchTrouble::kNegativeForce});
  EXPECT_EQ(processor.bench_trouble(), BenchTrouble::kNegativeForce);
  feed(processor, std::vector<double>(200, 0.3), 1300, 10);
  EXPECT_EQ(processor.bench_trouble(), BenchTrouble::kNone);
}

TEST(Commands, AForceThatStaysIsToldOnce) {
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  feed(processor, std::vector<double>(100, 0.0), 0, 10);
  feed(processor, std::vector<double>(50, 0.3), 100, 10);
  EXPECT_EQ(processor.stop("ada").refusal, "");
  feed(processor, std::vector<double>(990, 0.3), 150, 10);
  EXPECT_TRUE(record.stays.empty());
  feed(processor, std::vector<double>(2000, 0.3), 1140, 10);
  EXPECT_EQ(record.stays, std::vector{BenchState::kFinishing});
}

// Told once, when its time is over and no scan before; a bench that arms itself waits for ever.
TEST(Commands, EachStateHasItsPatience) {
  struct Case {
    bool automatic;
    double slip;  ///< Of a force that rises and falls all the time.
    void (*into)(Processor&);
    BenchState state;
    BenchTrouble trouble;
    int longest_s;
  };
  const auto armed = [](Processor& processor) { EXPECT_EQ(processor.arm("ada").refusal, ""); };
  const auto started = [](Processor& processor) { EXPECT_EQ(processor.start("ada").refusal, ""); };
  const auto untouched = [](Processor& /*processor*/) {};
  for (const Case& one : {Case{false, 0.0, armed, BenchState::kArmed, BenchTrouble::kLongArmed, 600},
                          Case{false, 0.0, started, BenchState::kLoading, BenchTrouble::kLongLoading, 60},
                          Case{false, 0.1, started, BenchState::kRunning, BenchTrouble::kLongRunning, 600},
                          Case{true, 0.0, untouched, BenchState::kArmed, BenchTrouble::kNone, 700},
                          Case{false, 0.0, untouched, BenchState::kIdle, BenchTrouble::kNone, 700}}) {
    Recorder record;
    Processor processor{settings_of(one.automatic), coefficients(), {&record}};
    feed(processor, std::vector<double>(100, 0.0), 0, 10);
    one.into(processor);
    daq::ScanIndex next = 100;
    const auto feed_scans = [&](int count) {
      std::vector<double> force;
      for (int k = 0; k < count; ++k, ++next) {
        const double phase = std::fmod(static_cast<double>(next), 20.0) / 20.0;
        force.push_back(one.slip * (3.0 + (phase < 0.8 ? phase : 4.0 * (1.0 - phase))));
      }
      feed(processor, force, next - count, 10);
    };
    while (processor.bench() != one.state && next < 1000) feed_scans(1);
    ASSERT_EQ(processor.bench(), one.state);
    // Where a scan changed the state, it is the first one in it.
    const int counted = next > 100 ? 1 : 0;
    feed_scans(one.longest_s * static_cast<int>(kRate_Hz) - 1 - counted);
    EXPECT_TRUE(record.troubles.empty()) << name(one.state);
    feed_scans(100);
    const std::vector<BenchTrouble> told =
        one.trouble == BenchTrouble::kNone ? std::vector<BenchTrouble>{} : std::vector{one.trouble};
    EXPECT_EQ(record.troubles, told) << name(one.state);
    EXPECT_EQ(words(one.trouble).empty(), told.empty());
  }
}

TEST(Commands, APullBeforeTheForceOfTheLastTestIsGoneIsTold) {
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  std::vector<double> force(100, 0.0);
  const auto pull = [&force](double zero) {
    for (int k = 0; k < 100; ++k) force.push_back(zero + 0.3 + 0.1 * std::fmod(k, 20.0) / 20.0);
  };
  pull(0.0);
  force.insert(force.end(), 150, 0.36);  // The belt stands.
  force.insert(force.end(), 30, 0.04);   // The zero has moved: too short to see that.
  pull(0.04);
  force.insert(force.end(), 100, 0.04);
  pull(0.04);
  force.insert(force.end(), 100, 0.04);
  feed(processor, force, 0, 10);
  EXPECT_EQ(record.troubles, std::vector{BenchTrouble::kPulledAgain});
  EXPECT_EQ(processor.bench_trouble(), BenchTrouble::kNone) << "the bench is armed again";
  EXPECT_EQ(record.tests.size(), 2U);
}

TEST(Commands, ATareLeavesFinishingWhereTheForceIsQuiet) {
  daq::BoardInfo volts;
  volts.quantity = daq::RawQuantity::kVolts;
  Recorder record;
  Processor processor{settings_of(true), {volts, {1.0, 0.0}, 1.0}, {&record}};
  auto stay = [&processor, at = daq::ScanIndex{0}](double force, std::size_t scans) mutable {
    feed(processor, std::vector<double>(scans, force), at, 10);
    at += static_cast<daq::ScanIndex>(scans);
  };
  stay(0.0, 100);
  stay(0.2, 100);
  EXPECT_EQ(processor.stop("ada").refusal, "");
  stay(0.2, 200);
  EXPECT_NE(processor.tare("ada").refusal.find("is a load"), std::string::npos);
  EXPECT_EQ(processor.bench(), BenchState::kFinishing);
  // More than a third of that test's force: not unloaded by itself.
  stay(0.09, 20);
  EXPECT_NE(processor.tare("ada").refusal.find("not quiet"), std::string::npos);
  stay(0.09, 200);
  EXPECT_EQ(processor.bench(), BenchState::kFinishing);
  EXPECT_EQ(processor.tare("ada").refusal, "");
  EXPECT_EQ(processor.bench(), BenchState::kArmed);
  stay(0.09, 50);
  stay(0.29, 100);
  stay(0.09, 50);
  EXPECT_EQ(record.tests.size(), 2U);
  EXPECT_EQ(processor.bench(), BenchState::kArmed);
}

TEST(Commands, StoppingLeavesTheForceToGoAway) {
  Recorder record;
  Processor processor{settings_of(true), coefficients(), {&record}};
  feed(processor, std::vector<double>(100, 0.0), 0, 10);
  feed(processor, std::vector<double>(50, 0.3), 100, 10);
  EXPECT_EQ(processor.mark("here").scan, 149);
  EXPECT_EQ(processor.stop("ada").refusal, "");
  EXPECT_EQ(record.tests.at(0).end.cause, EndCause::kCommand);
  EXPECT_EQ(record.tests.at(0).end.end, 150);
  EXPECT_EQ(processor.bench(), BenchState::kFinishing);
  EXPECT_NE(processor.start("ada").refusal, "");
  EXPECT_NE(processor.stop("ada").refusal, "");
  EXPECT_NE(processor.mark("there").refusal, "");
  feed(processor, std::vector<double>(50, 0.3), 150, 10);
  EXPECT_EQ(record.tests.size(), 1U) << "what is left of the force begins no test";
  feed(processor, std::vector<double>(50, 0.0), 200, 10);
  EXPECT_EQ(processor.bench(), BenchState::kArmed);
}

}  // namespace
}  // namespace stickslip::pipeline
