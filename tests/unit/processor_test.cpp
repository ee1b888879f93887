#include "core/pipeline/processor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::pipeline {
namespace {

/// Writes down what it is told, one word each.
class Diary final : public Sink {
 public:
  void test_began(const TestStart& start) override {
    words.push_back("began");
    starts.push_back(start);
    next = start.first;
  }
  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second,
             const daq::ClockStamp&) override {
    EXPECT_EQ(first, next) << "scans arrive in order, each once";
    next = first + static_cast<daq::ScanIndex>(raw.size());
    if (words.empty() || words.back() != "scans") words.push_back("scans");
    values.insert(values.end(), raw.begin(), raw.end());
    codes.insert(codes.end(), second.begin(), second.end());
  }
  void anchor(const daq::ClockAnchor& anchor) override { anchors.push_back(anchor); }
  void gap(const daq::Gap& gap) override {
    words.push_back("gap");
    gaps.push_back(gap);
    next = gap.first + gap.count;
  }
  void bench_stays(BenchState, double duration_s, BenchTrouble trouble) override {
    troubles.emplace_back(trouble, duration_s);
  }
  void note(const daq::Note& note) override { notes.push_back(note.text); }
  void observed(daq::ScanIndex, std::span<const double> coefficient, const detect::LiveState&) override {
    coefficients.insert(coefficients.end(), coefficient.begin(), coefficient.end());
  }
  void test_ended(const TestEnd& end) override {
    words.push_back("ended");
    ends.push_back(end);
    EXPECT_EQ(end.end, next);
  }

  std::vector<std::string> words;
  std::vector<TestStart> starts;
  std::vector<double> values;
  std::vector<std::int32_t> codes;
  std::vector<daq::Gap> gaps;
  std::vector<daq::ClockAnchor> anchors;
  std::vector<TestEnd> ends;
  std::vector<std::pair<BenchTrouble, double>> troubles;  ///< And the time in the state, s.
  std::vector<std::string> notes;
  std::vector<double> coefficients;  ///< Of all scans.
  daq::ScanIndex next = 0;
};

/// Readings are coefficients, 100 scans/s: unloaded 1 s, loaded 2 s, unloaded 1 s.
class ProcessorTest : public testing::Test {
 protected:
  static constexpr daq::ScanIndex kLoaded = 100;
  static constexpr daq::ScanIndex kUnloaded = 300;
  static constexpr daq::ScanIndex kEnd = 400;

  ProcessorTest() {
    settings_.segmenter.scan_rate_Hz = 100.0;
    settings_.segmenter.start_dwell_s = 0.02;
    settings_.segmenter.pre_trigger_s = 0.5;
    settings_.segmenter.unload_dwell_s = 0.1;
    settings_.analysis.scan_rate_Hz = 100.0;
    board_.quantity = daq::RawQuantity::kCoefficient;
  }

  static double reading(daq::ScanIndex index) {
    const daq::ScanIndex in_test = index % kEnd;
    return in_test >= kLoaded && in_test < kUnloaded ? 0.3 : 0.0;
  }

  Processor make() { return {settings_, {board_, {}, 1.0}, {&diary_}}; }

  static void feed(Processor& processor, daq::ScanIndex first, daq::ScanIndex end,
                   daq::ScanIndex block_size = 7, daq::GapCause cause = daq::GapCause::kRingFull) {
    while (first < end) {
      daq::ScanBlock block;
      block.first = first;
      while (first < end && static_cast<daq::ScanIndex>(block.count) < block_size) {
        block.second[block.count] = static_cast<std::int32_t>(first);
        block.raw[block.count++] = reading(first++);
      }
      processor.process(block, cause);
    }
  }

  static void expect_same_results(const TestEnd& a, const TestEnd& b) {
    std::vector<analysis::Estimate> results;
    analysis::for_each_result(a.results, [&](const analysis::ResultName&, const analysis::Estimate& result) {
      results.push_back(result);
    });
    std::size_t at = 0;
    analysis::for_each_result(b.results,
                              [&](const analysis::ResultName& name, const analysis::Estimate& result) {
                                EXPECT_EQ(results[at].value, result.value) << name.name;
                                EXPECT_EQ(results[at].systematic_uncertainty, result.systematic_uncertainty);
                                ++at;
                              });
  }

  ProcessorSettings settings_;
  daq::BoardInfo board_;
  Diary diary_;
};

TEST_F(ProcessorTest, CutsTestsOutWithTheirPreTriggerScans) {
  Processor processor = make();
  feed(processor, 0, 2 * kEnd);
  processor.finish(EndCause::kEndOfInput);
  EXPECT_EQ(diary_.words, (std::vector<std::string>{"began", "scans", "ended", "began", "scans", "ended"}));
  // The trigger is the second loaded scan in a row; half a second is kept from before it.
  EXPECT_EQ(diary_.starts[0].trigger, kLoaded + 1);
  EXPECT_EQ(diary_.starts[0].first, kLoaded + 1 - 50);
  EXPECT_EQ(diary_.ends[0].end, kUnloaded + 10);
  EXPECT_EQ(diary_.ends[0].cause, EndCause::kUnloaded);
  EXPECT_EQ(diary_.ends[1].number, 2);
  EXPECT_EQ(processor.test_number(), 3);
  EXPECT_EQ(processor.scan_count(), 800U);
}

// The code of scan i is i.
TEST_F(ProcessorTest, SecondChannelGoesWithItsScansThoseBeforeTheTriggerToo) {
  board_.second.emplace().maxdata = 1000;
  settings_.second = board_.second;
  Processor processor = make();
  feed(processor, 0, kEnd);
  ASSERT_EQ(diary_.codes.size(), diary_.values.size());
  for (std::size_t i = 0; i < diary_.codes.size(); ++i) {
    ASSERT_EQ(diary_.codes[i], diary_.starts.at(0).first + static_cast<daq::ScanIndex>(i));
  }
}

TEST_F(ProcessorTest, WithoutASecondChannelNoneIsTold) {
  Processor processor = make();
  feed(processor, 0, kEnd);
  EXPECT_TRUE(diary_.codes.empty());
}

// How scans are divided into blocks is an accident of timing and must not matter.
TEST_F(ProcessorTest, DoesNotDependOnTheSizeOfBlocks) {
  std::vector<std::vector<double>> values;
  for (const daq::ScanIndex size : {1, 7, 64}) {
    diary_ = {};
    Processor processor = make();
    feed(processor, 0, kEnd, size);
    processor.finish(EndCause::kEndOfInput);
    EXPECT_EQ(diary_.ends.at(0).end, kUnloaded + 10);
    values.push_back(diary_.values);
  }
  EXPECT_EQ(values[0], values[1]);
  EXPECT_EQ(values[0], values[2]);
}

// Each index is in a test, in a gap, or discarded by who discards it; at no moment elsewhere but in the
// stretch before a test.
TEST_F(ProcessorTest, EveryIndexIsRecordedIdleOrInAGap) {
  Processor processor = make();
  constexpr daq::ScanIndex kPreTrigger = 50;
  feed(processor, 0, 30);
  EXPECT_EQ(processor.idle_scan_count(), 0) << "all of them may belong to a coming test";
  feed(processor, 30, 90);
  EXPECT_EQ(processor.idle_scan_count(), 90 - kPreTrigger);
  feed(processor, 95, 150);  // Outside of a test: what was before the gap is given up.
  EXPECT_EQ(processor.idle_scan_count(), 90);
  feed(processor, 160, 3 * kEnd);  // Inside of one.
  processor.finish(EndCause::kStopped);
  EXPECT_EQ(diary_.ends.size(), 3U);
  EXPECT_EQ(processor.lost_scan_count(), 15);
  EXPECT_EQ(static_cast<daq::ScanIndex>(diary_.values.size()) + processor.idle_scan_count() +
                processor.lost_scan_count(),
            3 * kEnd);
}

TEST_F(ProcessorTest, ScansGivenUpByCommandsAreIdle) {
  settings_.automatic = false;
  Processor processor = make();
  feed(processor, 0, 90);
  static_cast<void>(processor.arm("ada"));
  feed(processor, 90, kEnd);
  processor.finish(EndCause::kStopped);
  EXPECT_EQ(static_cast<daq::ScanIndex>(diary_.values.size()) + processor.idle_scan_count(), kEnd);
}

// A self-check is about the scans right before the record: not about those before a load that was given up.
TEST_F(ProcessorTest, WhatACommandGivesUpHasNoSelfCheck) {
  settings_.automatic = false;
  board_.quantity = daq::RawQuantity::kVolts;
  for (const bool tares : {false, true}) {
    diary_ = {};
    Processor processor = make();
    feed(processor, 0, kLoaded + 20);
    if (tares) {
      EXPECT_EQ(processor.tare("ada").refusal, "");
    }
    static_cast<void>(processor.arm("ada"));
    feed(processor, kLoaded + 20, kEnd);
    ASSERT_EQ(diary_.starts.size(), 1U);
    EXPECT_EQ(diary_.starts[0].first, kLoaded + 20);
    EXPECT_EQ(diary_.starts[0].self_check, nullptr) << tares;
  }
}

// A bench that scans for 142 days at 350 Hz passes 2^32; nothing may be cut to 32 bits on the way, nor lose
// digits.
TEST_F(ProcessorTest, TheSameScansBeyond32BitsOfTheIndexGiveTheSameResults) {
  Processor early = make();
  feed(early, 0, kEnd);
  early.finish(EndCause::kEndOfInput);
  // A multiple of kEnd, so that the readings are the same, and 2^32 is among the scans of the record.
  constexpr daq::ScanIndex kWrap = daq::ScanIndex{1} << 32;
  constexpr daq::ScanIndex kShift = kWrap - kWrap % kEnd;
  static_assert(kShift + kLoaded - 50 < kWrap && kWrap < kShift + kUnloaded);
  Processor late = make();
  feed(late, kShift, kShift + kEnd);
  late.finish(EndCause::kEndOfInput);
  ASSERT_EQ(diary_.ends.size(), 2U);
  EXPECT_EQ(diary_.starts[1].trigger, diary_.starts[0].trigger + kShift);
  EXPECT_EQ(diary_.ends[1].end, diary_.ends[0].end + kShift);
  expect_same_results(diary_.ends[0], diary_.ends[1]);
  EXPECT_EQ(late.idle_scan_count(), early.idle_scan_count());
}

TEST_F(ProcessorTest, TellsAGapInsideATestAndForgetsWhatWasBeforeOneOutside) {
  Processor processor = make();
  feed(processor, 0, 90);
  feed(processor, 95, 150);  // Before the trigger: the record begins behind the gap.
  feed(processor, 160, kEnd);
  processor.finish(EndCause::kEndOfInput);
  EXPECT_EQ(diary_.starts.at(0).first, 95);
  ASSERT_EQ(diary_.gaps.size(), 1U);
  EXPECT_EQ(diary_.gaps[0].first, 150);
  EXPECT_EQ(diary_.gaps[0].count, 10);
  EXPECT_EQ(diary_.gaps[0].cause, daq::GapCause::kRingFull);
  EXPECT_EQ(processor.gap_count(), 2U);
  EXPECT_EQ(diary_.ends.at(0).results.lost_scan_count.value, 10.0);
}

TEST_F(ProcessorTest, CommandsBeforeTheFirstBlockKnowWhereTheAcquisitionGoesOn) {
  settings_.continues_at = 5000;
  settings_.automatic = false;
  Processor processor = make();
  EXPECT_EQ(processor.arm("somebody").scan, 5000);
}

// Delays of reads on both sides of an estimated gap cannot be compared: each side has its own anchor.
TEST_F(ProcessorTest, AnEstimatedGapEndsTheWindowOfAnAnchor) {
  Processor processor = make();
  feed(processor, 0, 125);
  ASSERT_TRUE(diary_.anchors.empty());
  feed(processor, 130, 140, 7, daq::GapCause::kOverrun);
  ASSERT_EQ(diary_.anchors.size(), 1U);
  EXPECT_LT(diary_.anchors[0].scan, 125);
  feed(processor, 140, kEnd);
  EXPECT_GE(diary_.anchors.at(1).scan, 130);
}

// The clocks of then are the record's: those of its replay say nothing of it.
TEST_F(ProcessorTest, LatencyOfReadsIsThatOfTheRecordWhereOneIsReplayed) {
  auto recorded = std::make_shared<daq::RecordedFacts>();
  recorded->read_latency = daq::LatencyHistogram{{5, 4, 3}, 60e-6};
  settings_.recorded = recorded;
  Processor processor = make();
  feed(processor, 0, kEnd);
  EXPECT_EQ(diary_.ends.at(0).read_latency, recorded->read_latency);
}

TEST_F(ProcessorTest, NoLatencyIsToldByAClockThatIsNotTheMachines) {
  settings_.clock_is_real = false;
  Processor processor = make();
  feed(processor, 0, kEnd);
  EXPECT_FALSE(diary_.ends.at(0).read_latency);
}

TEST_F(ProcessorTest, EndsARunningTestWhenToldAndNothingElse) {
  Processor processor = make();
  feed(processor, 0, 200);
  EXPECT_TRUE(processor.test_is_running());
  processor.finish(EndCause::kStopped);
  EXPECT_FALSE(processor.test_is_running());
  ASSERT_EQ(diary_.ends.size(), 1U);
  EXPECT_EQ(diary_.ends[0].cause, EndCause::kStopped);
  EXPECT_EQ(diary_.ends[0].end, 200);
  processor.finish(EndCause::kStopped);
  EXPECT_EQ(diary_.ends.size(), 1U);
}

TEST_F(ProcessorTest, ANewCalibrationCountsAsIfItHadAlwaysBeen) {
  settings_.automatic = false;
  settings_.calibration.gain_uncertainty = 0.1;
  board_.quantity = daq::RawQuantity::kVolts;
  const daq::LoadCell cell{2.0, 0.01};
  Processor before{settings_, {board_, {1.5, 0.0}, 1.0}, {&diary_}};
  feed(before, 0, 20);
  const CommandReport report = before.recalibrate({board_, cell, 1.0}, {.gain_uncertainty = 0.02}, "ada");
  EXPECT_EQ(report.refusal, "");
  EXPECT_EQ(report.scan, 20);
  settings_.calibration.gain_uncertainty = 0.02;
  Diary other;
  Processor always{settings_, {board_, cell, 1.0}, {&other}};
  feed(always, 0, 20);
  for (Processor* processor : {&before, &always}) {
    feed(*processor, 20, 90);
    EXPECT_EQ(processor->start("ada").refusal, "");
    feed(*processor, 90, kEnd);
  }
  ASSERT_EQ(diary_.ends.size(), 1U);
  ASSERT_EQ(other.ends.size(), 1U);
  EXPECT_EQ(diary_.starts[0].first, other.starts[0].first);
  EXPECT_EQ(diary_.ends[0].end, other.ends[0].end);
  EXPECT_EQ(diary_.coefficients.back(), before.calibration().coefficient(reading(kEnd - 1)));
  EXPECT_NE(diary_.coefficients.front(), diary_.coefficients[20]) << "the same voltage, before and after";
  EXPECT_TRUE(std::equal(diary_.coefficients.begin() + 20, diary_.coefficients.end(),
                         other.coefficients.begin() + 20, other.coefficients.end()));
  expect_same_results(diary_.ends[0], other.ends[0]);
  ASSERT_FALSE(diary_.notes.empty());
  EXPECT_EQ(diary_.notes[0], "load cell calibrated: 2 N/V, zero 0.01 V, from scan 20, by ada");
}

// The record states one zero: its scans from before the tare are read with it too, by the test and by any
// replay.
TEST_F(ProcessorTest, ScansFromBeforeATareCountWithTheNewZero) {
  settings_.segmenter.pre_trigger_s = 0.2;
  board_.quantity = daq::RawQuantity::kVolts;
  Processor tared{settings_, {board_, {2.0, -0.01}, 1.0}, {&diary_}};
  feed(tared, 0, 95);
  const TareReport report = tared.tare("ada");
  EXPECT_EQ(report.refusal, "");
  EXPECT_EQ(report.scan, 95);
  EXPECT_NEAR(report.zero_V, 0.0, 1e-15);
  Diary other;
  Processor always{settings_, {board_, {2.0, report.zero_V}, 1.0}, {&other}};
  feed(always, 0, 95);
  feed(tared, 95, kEnd);
  feed(always, 95, kEnd);
  ASSERT_EQ(diary_.ends.size(), 1U);
  ASSERT_EQ(other.ends.size(), 1U);
  EXPECT_LT(diary_.starts[0].first, report.scan);
  EXPECT_EQ(diary_.starts[0].first, other.starts[0].first);
  EXPECT_EQ(diary_.values, other.values) << "raw, whatever the zero";
  expect_same_results(diary_.ends[0], other.ends[0]);
}

// The analysis too sees the scans that waited with the new zero: what it left out as a spike says so.
TEST_F(ProcessorTest, WhatWaitsIsCalibratedAnewByATare) {
  settings_.segmenter.pre_trigger_s = 0.95;  // A spike needs the noise of 68 scans before it.
  board_.quantity = daq::RawQuantity::kVolts;
  Processor tared{settings_, {board_, {2.0, -0.01}, 1.0}, {&diary_}};
  constexpr daq::ScanIndex kPull = 500;  // The bench is quiet for longer before it.
  constexpr daq::ScanIndex kTare = kPull - 5;
  constexpr daq::ScanIndex kSpike = kPull - 15;
  constexpr double kSpike_V = -0.2;  // Upwards it would be a load.
  const auto feed_noise = [&tared](daq::ScanIndex first, daq::ScanIndex end) {
    std::mt19937 random{7};
    std::normal_distribution<double> noise{0.0, 1e-4};
    for (daq::ScanIndex index = 0; index < end; ++index) {
      const double value = (index < kPull ? 0.0 : reading(index - kPull + kLoaded)) + noise(random);
      if (index < first) continue;
      daq::ScanBlock block;
      block.first = index;
      block.count = 1;
      block.raw[0] = index == kSpike ? kSpike_V : value;
      tared.process(block, daq::GapCause::kRingFull);
    }
  };
  feed_noise(0, kTare);
  const TareReport report = tared.tare("ada");
  ASSERT_EQ(report.refusal, "");
  feed_noise(kTare, kPull - kLoaded + kEnd);
  ASSERT_EQ(diary_.ends.size(), 1U);
  ASSERT_EQ(diary_.ends[0].spikes, std::vector<daq::ScanIndex>{kSpike});
  EXPECT_EQ(diary_.ends[0].spike_coefficients.at(0), (kSpike_V - report.zero_V) * 2.0);
}

TEST_F(ProcessorTest, ANewCalibrationNeedsAnIdleBench) {
  Processor armed = make();
  EXPECT_EQ(armed.recalibrate({board_, {}, 2.0}, {}, "ada").refusal,
            "the bench is armed; a new calibration needs it idle");
  feed(armed, 0, 200);
  EXPECT_EQ(armed.recalibrate({board_, {}, 2.0}, {}, "ada").refusal,
            "the bench is loading; a new calibration needs it idle");
  EXPECT_EQ(armed.calibration().normal_load_N(), 1.0);
}

// An automatic bench waits armed for as long as it takes: what is told there has its time all the same.
TEST_F(ProcessorTest, TimeInAStateWithoutALimitIsCounted) {
  Processor processor = make();
  ASSERT_EQ(patience(BenchState::kArmed, settings_.automatic).trouble, BenchTrouble::kNone);
  constexpr daq::ScanIndex kNegative = 1000;
  for (daq::ScanIndex first = 0; first < 3 * kNegative; first += 10) {
    daq::ScanBlock block;
    block.first = first;
    block.count = 10;
    std::fill_n(block.raw.begin(), 10, first < kNegative ? 0.0 : -0.3);
    processor.process(block, daq::GapCause::kRingFull);
  }
  ASSERT_EQ(diary_.troubles.size(), 1U);
  EXPECT_EQ(diary_.troubles[0].first, BenchTrouble::kNegativeForce);
  EXPECT_GT(diary_.troubles[0].second, 10.0);
}

}  // namespace
}  // namespace stickslip::pipeline
