#include "core/pipeline/segmenter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace stickslip::pipeline {
namespace {

using Event = Segmenter::Event;
using std::numbers::pi;

constexpr double kSigma = 0.001;

/// 0.010 s, 0.25 s and 0.25 s of the defaults at 350 Hz, rounded half up (87.5 → 88, 3.5 → 4).
constexpr std::int64_t kStartDwell = 4;
constexpr std::int64_t kUnloadDwell = 88;
constexpr std::int64_t kPreTrigger = 88;

struct Seen {
  base::ScanIndex scan = 0;
  Event event = Event::kNone;
  bool operator==(const Seen&) const = default;
};

std::vector<Seen> events_in(const std::vector<double>& values, base::ScanIndex first = 0) {
  Segmenter segmenter{SegmenterSettings{}};
  std::vector<Seen> seen;
  base::ScanIndex scan = first;
  for (const double value : values) {
    if (const Event event = segmenter.observe(scan, value); event != Event::kNone)
      seen.push_back({scan, event});
    ++scan;
  }
  return seen;
}

/// Parts of a test, one after the other, with white noise.
class Course {
 public:
  explicit Course(std::uint64_t seed = 1) : engine_(seed) {}

  Course& level(double value, int scans) {
    for (int k = 0; k < scans; ++k) push(value);
    return *this;
  }
  /// Loading from rest at the belt's rate.
  Course& load(double to, int scans) {
    for (int k = 0; k < scans; ++k) push(to * k / scans);
    return *this;
  }
  /// The middle of the oscillation is 0.3. \param decay  per cycle.
  Course& oscillate(double amplitude, int cycles, double decay = 1.0, double scans_per_cycle = 17.5) {
    const int scans = static_cast<int>(cycles * scans_per_cycle);
    for (int k = 0; k < scans; ++k) {
      const double cycle = k / scans_per_cycle;
      push(0.3 + amplitude * std::pow(decay, cycle) * std::sin(2.0 * pi * cycle));
    }
    return *this;
  }
  [[nodiscard]] const std::vector<double>& values() const noexcept { return values_; }
  [[nodiscard]] base::ScanIndex size() const noexcept { return static_cast<base::ScanIndex>(values_.size()); }

 private:
  void push(double value) { values_.push_back(value + normal_(engine_)); }

  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_{0.0, kSigma};
  std::vector<double> values_;
};

TEST(Segmenter, TestStartsWhenTheForceHasStayedAboveTheTrigger) {
  std::vector<double> values(500, 0.0);
  values.insert(values.end(), 20, 0.06);
  EXPECT_EQ(events_in(values), (std::vector<Seen>{{500 + kStartDwell - 1, Event::kTestStarts}}));
}

TEST(Segmenter, ForceAtTheTriggerCountsAndBelowItDoesNot) {
  // A force that has never been below the trigger may be a zero that is off.
  std::vector<double> values(51, 0.05);
  EXPECT_TRUE(events_in(values).empty());
  values.front() = 0.0;
  EXPECT_EQ(events_in(values).size(), 1U);
  EXPECT_TRUE(events_in(std::vector<double>(50, std::nextafter(0.05, 0.0))).empty());
}

TEST(Segmenter, SpikesShorterThanTheDwellStartNothing) {
  std::vector<double> values(1000, 0.0);
  for (const std::size_t at : {100U, 200U, 300U}) values[at] = 5.0;
  for (const std::size_t at : {400U, 401U, 500U, 501U, 502U}) values[at] = 5.0;
  EXPECT_TRUE(events_in(values).empty());
}

// A pull of a sled whose cell is wired the wrong way round: no test, and one event for the pull.
TEST(Segmenter, ForceOfTheWrongSignIsToldOnceAPull) {
  std::vector<double> values(200, 0.0);
  for (int pull = 0; pull < 2; ++pull) {
    values.insert(values.end(), 500, -0.3);
    values.insert(values.end(), 200, 0.0);
  }
  const base::ScanIndex told = 200 + kUnloadDwell - 1;
  EXPECT_EQ(events_in(values), (std::vector<Seen>{{told, Event::kNegative}, {told + 700, Event::kNegative}}));
}

TEST(Segmenter, ForceJustBelowZeroOrForAMomentIsNotOfTheWrongSign) {
  std::vector<double> values(200, 0.0);
  values.insert(values.end(), 500, -0.049);
  values.insert(values.end(), 50, 0.0);
  values.insert(values.end(), kUnloadDwell - 1, -0.3);
  values.insert(values.end(), 200, 0.0);
  EXPECT_TRUE(events_in(values).empty());
}

// Of a negative force seen on both sides of a gap nobody knows what was between.
TEST(Segmenter, ForceOfTheWrongSignIsNotCountedOverAGap) {
  Segmenter segmenter{SegmenterSettings{}};
  std::vector<Event> seen;
  base::ScanIndex scan = 0;
  const auto observe = [&](double value, int scans) {
    for (int k = 0; k < scans; ++k) {
      if (const Event event = segmenter.observe(scan++, value); event != Event::kNone) seen.push_back(event);
    }
  };
  observe(0.0, 200);
  observe(-0.3, kUnloadDwell - 1);
  scan += 100;
  observe(-0.3, kUnloadDwell - 1);
  EXPECT_TRUE(seen.empty());
  observe(-0.3, 1);
  EXPECT_EQ(seen, std::vector{Event::kNegative});
}

// A carriage with a stiff coupling pushes the sled back after each test. Wires that were swapped between two
// tests are told at the second pull.
TEST(Segmenter, ACarriageThatPushesTheSledBackIsNoForceOfTheWrongSign) {
  for (const int rest : {0, 50, 200}) {
    std::vector<double> values(200, 0.0);
    for (int test = 0; test < 3; ++test) {
      values.insert(values.end(), 500, 0.3);
      values.insert(values.end(), static_cast<std::size_t>(rest), 0.0);
      values.insert(values.end(), 400, -0.2);
      values.insert(values.end(), 300, 0.0);
    }
    for (const Seen& seen : events_in(values)) EXPECT_NE(seen.event, Event::kNegative) << rest;
    values.insert(values.end(), 400, -0.2);
    EXPECT_EQ(events_in(values).back().event, Event::kNegative) << rest;
  }
}

TEST(Segmenter, PreTriggerScansAreTimeTimesRate) {
  SegmenterSettings settings;
  EXPECT_EQ(settings.pre_trigger_scans(), static_cast<std::size_t>(kPreTrigger));
  settings.pre_trigger_s = 0.0;
  EXPECT_EQ(settings.pre_trigger_scans(), 0U);
}

TEST(Segmenter, UnloadingEndsTheTest) {
  std::vector<double> values(200, 0.0);
  values.insert(values.end(), 300, 0.3);
  values.insert(values.end(), 200, 0.0);
  EXPECT_EQ(events_in(values),
            (std::vector<Seen>{{203, Event::kTestStarts}, {500 + kUnloadDwell - 1, Event::kUnloaded}}));
}

TEST(Segmenter, RestBeforeTheLoadDoesNotEndATestThatACommandBegan) {
  // The load may begin at any scan of a quiet stretch, whose quarters have 43 scans.
  for (int rest = 200; rest < 300; ++rest) {
    Course course;
    course.level(0.0, rest).load(0.3, 20).oscillate(0.05, 30);
    const base::ScanIndex end = course.size();
    course.level(0.0, 2 * kUnloadDwell);
    Segmenter segmenter{SegmenterSettings{}};
    segmenter.trigger_by_force(false);
    segmenter.start();
    std::vector<Seen> seen;
    for (base::ScanIndex scan = 0; scan < course.size(); ++scan) {
      if (const Event event = segmenter.observe(scan, course.values()[static_cast<std::size_t>(scan)]);
          event != Event::kNone)
        seen.push_back({scan, event});
    }
    ASSERT_EQ(seen.size(), 2U) << rest;
    EXPECT_EQ(seen[0], (Seen{0, Event::kTestStarts}));
    EXPECT_EQ(seen[1].event, Event::kUnloaded);
    EXPECT_GT(seen[1].scan, end) << rest;
  }
}

TEST(Segmenter, SlackPartOfACycleDoesNotEndTheTest) {
  // Force near zero for 60 of every 90 scans, shorter than the dwell of 88.
  std::vector<double> values(200, 0.0);
  for (int cycle = 0; cycle < 30; ++cycle) {
    for (int k = 0; k < 90; ++k) values.push_back(k < 30 ? 0.02 * k : 0.0);
  }
  const std::vector<Seen> seen = events_in(values);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].event, Event::kTestStarts);
}

TEST(Segmenter, BeltThatStopsInFullSwingEndsTheTest) {
  // Flat for 0.5 s (175 scans) after the last change of the smoothed force by 6 σ. At the latest that
  // is when it has settled from 0.09 = 90 σ to its own noise, σ/√15: 8 ln(90 √15) = 47 scans. Despiker
  // and median of three delay by three; a pause in the fall may have begun up to 15 scans before.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Course course{seed};
    course.level(0.0, 200).load(0.3, 20).oscillate(0.05, 60);
    const base::ScanIndex stop = course.size();
    course.level(0.34, 700);
    const std::vector<Seen> seen = events_in(course.values());
    ASSERT_EQ(seen.size(), 2U) << seed;
    EXPECT_EQ(seen[1].event, Event::kNoRelativeMotion);
    EXPECT_GE(seen[1].scan, stop + 160);
    EXPECT_LE(seen[1].scan, stop + 175 + 47 + 3);
  }
}

TEST(Segmenter, RingDownIntoSteadySlidingDoesNotEndTheTest) {
  for (const double decay : {0.87, 0.7, 0.5}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Course course{seed};
      course.level(0.0, 200).load(0.3, 20).oscillate(0.08, 60, decay).level(0.3, 1000);
      const std::vector<Seen> seen = events_in(course.values());
      ASSERT_EQ(seen.size(), 1U) << decay << " seed " << seed;
    }
  }
}

// The smoothed force of a small oscillation may stay within six standard deviations; its falls show that the
// belt moves.
TEST(Segmenter, SmallOscillationDoesNotEndTheTest) {
  for (const double scans_per_cycle : {10.0, 17.5}) {
    for (const double drop_sigmas : {18.0, 28.0, 40.0}) {
      Course course;
      course.level(0.0, 200).load(0.3, 20).oscillate(0.5 * drop_sigmas * kSigma, 200, 1.0, scans_per_cycle);
      EXPECT_EQ(events_in(course.values()).size(), 1U) << drop_sigmas << ", " << scans_per_cycle;
    }
  }
}

// The last fall of twelve standard deviations is more than half of the first, of 20: nevertheless the
// oscillation has decayed, not stopped.
TEST(Segmenter, SmallRingDownIntoSteadySlidingDoesNotEndTheTest) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Course course{seed};
    course.level(0.0, 200).load(0.3, 20).oscillate(10.0 * kSigma, 60, 0.9).level(0.3, 1000);
    EXPECT_EQ(events_in(course.values()).size(), 1U) << seed;
  }
}

TEST(Segmenter, StaticPeakBeforeSteadySlidingDoesNotEndTheTest) {
  // A single fall that the force recovers from, then the flat force of a sled that slides: no oscillation
  // has been there that could have stopped.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Course course{seed};
    course.level(0.0, 200).load(0.4, 27).level(0.27, 10).level(0.3, 1000);
    EXPECT_EQ(events_in(course.values()).size(), 1U) << seed;
  }
}

TEST(Segmenter, PauseOfThreePeriodsDoesNotEndTheTest) {
  // Slow stick-slip of 100 scans a cycle: the dwell of 175 scans is over, the four periods are not.
  constexpr int kPeriod = 100;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Course course{seed};
    course.level(0.0, 200).load(0.3, 20).oscillate(0.05, 10, 1.0, kPeriod).level(0.3, 3 * kPeriod);
    course.oscillate(0.05, 3, 1.0, kPeriod);
    EXPECT_EQ(events_in(course.values()).size(), 1U) << seed;
    // The belt stops; the fall before was up to one period ago, and smoothing takes 47 scans.
    const base::ScanIndex stop = course.size();
    course.level(0.3, 6 * kPeriod);
    const std::vector<Seen> seen = events_in(course.values());
    ASSERT_EQ(seen.size(), 2U) << seed;
    EXPECT_GE(seen[1].scan, stop + 3 * kPeriod);
    EXPECT_LE(seen[1].scan, stop + 4 * kPeriod + 47 + 3);
  }
}

TEST(Segmenter, FallsOfTheTestBeforeDoNotCount) {
  // Its large swings do not make those of the next test small …
  Course small;
  small.level(0.0, 200).load(0.3, 20).oscillate(0.2, 20).level(0.0, 200);
  small.load(0.3, 20).oscillate(0.05, 20).level(0.34, 700);
  const std::vector<Seen> seen = events_in(small.values());
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(seen[3].event, Event::kNoRelativeMotion);
  // … and its number of falls does not make an oscillation of a single one.
  Course single;
  single.level(0.0, 200).load(0.3, 20).oscillate(0.05, 20).level(0.0, 200);
  single.load(0.4, 27).level(0.27, 10).level(0.3, 1000);
  EXPECT_EQ(events_in(single.values()).size(), 3U);
}

TEST(Segmenter, SteadySlidingDoesNotEndTheTest) {
  Course course;
  course.level(0.0, 200).load(0.3, 20).level(0.3, 5000);
  EXPECT_EQ(events_in(course.values()).size(), 1U);
}

TEST(Segmenter, ArmsAgainOnlyAfterUnloading) {
  Course course;
  course.level(0.0, 200).load(0.3, 20).oscillate(0.05, 60).level(0.34, 700);
  // Force still on: more oscillation is no new test.
  course.oscillate(0.05, 20).level(0.34, 300);
  course.level(0.0, 200);
  const base::ScanIndex again = course.size();
  course.level(0.3, 50);
  const std::vector<Seen> seen = events_in(course.values());
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[1].event, Event::kNoRelativeMotion);
  EXPECT_EQ(seen[2], (Seen{again + kStartDwell - 1, Event::kTestStarts}));
}

TEST(Segmenter, RunningFromStartToEnd) {
  Segmenter segmenter{SegmenterSettings{}};
  EXPECT_FALSE(segmenter.running());
  base::ScanIndex scan = 0;
  for (int k = 0; k < kStartDwell; ++k) (void)segmenter.observe(scan++, 0.3);
  EXPECT_TRUE(segmenter.running());
  for (int k = 0; k < kUnloadDwell; ++k) (void)segmenter.observe(scan++, 0.0);
  EXPECT_FALSE(segmenter.running());
}

TEST(Segmenter, JumpOfTheIndexDoesNotFillTheDwell) {
  Segmenter segmenter{SegmenterSettings{}};
  for (base::ScanIndex k = 0; k < kStartDwell - 1; ++k) EXPECT_EQ(segmenter.observe(k, 0.3), Event::kNone);
  for (base::ScanIndex k = 100; k < 100 + kStartDwell - 1; ++k) {
    EXPECT_EQ(segmenter.observe(k, 0.3), Event::kNone);
  }
  EXPECT_EQ(segmenter.observe(100 + kStartDwell - 1, 0.3), Event::kTestStarts);
}

TEST(Segmenter, QuietStretchHasNoGap) {
  // A stretch of four quarters, 43 scans each, gives the level; scans from before a gap are none of it.
  constexpr base::ScanIndex kQuarter = 43;
  Segmenter segmenter{SegmenterSettings{}};
  base::ScanIndex scan = 0;
  for (; scan < 3 * kQuarter; ++scan) (void)segmenter.observe(scan, 0.03);
  const base::ScanIndex behind = scan + 1000;
  for (scan = behind; scan < behind + 4 * kQuarter; ++scan) {
    EXPECT_FALSE(segmenter.unloaded_level()) << scan;
    (void)segmenter.observe(scan, 0.03);
  }
  EXPECT_EQ(segmenter.unloaded_level(), 0.03);
}

TEST(Segmenter, TestByCommandIsLoadedAtTheTriggerThoughNoLevelIsKnown) {
  // 0.07 may be a zero that is off where a force is to begin a test; a command has begun this one.
  Segmenter segmenter{SegmenterSettings{}};
  segmenter.start();
  std::vector<double> values(20, 0.0);
  values.insert(values.end(), 100, 0.07);
  const auto end = static_cast<base::ScanIndex>(values.size());
  values.insert(values.end(), 100, 0.0);
  std::vector<Seen> seen;
  for (base::ScanIndex scan = 0; scan < static_cast<base::ScanIndex>(values.size()); ++scan) {
    if (const Event event = segmenter.observe(scan, values[static_cast<std::size_t>(scan)]);
        event != Event::kNone)
      seen.push_back({scan, event});
  }
  EXPECT_EQ(seen, (std::vector<Seen>{{0, Event::kTestStarts}, {end + kUnloadDwell - 1, Event::kUnloaded}}));
}

TEST(Segmenter, TestThatIsStoppedBeforeItsLoadLeavesTheCellUnloaded) {
  // The force has been below the end threshold for the dwell, whatever part of that was before the test.
  for (const int rest : {static_cast<int>(kUnloadDwell), 20}) {
    Segmenter segmenter{SegmenterSettings{}};
    base::ScanIndex scan = 0;
    while (scan < rest - 10) (void)segmenter.observe(scan++, 0.0);
    segmenter.start();
    while (scan < rest) (void)segmenter.observe(scan++, 0.0);
    ASSERT_TRUE(segmenter.running());
    segmenter.stop();
    EXPECT_EQ(segmenter.ready(), rest >= kUnloadDwell) << rest;
  }
}

TEST(Segmenter, RecordAloneStartsAndEndsAtTheSameScans) {
  // The record reaches from pre_trigger_scans() before the first scan above the trigger to the end.
  for (const bool unloading : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Course course{seed};
      course.level(0.0, 371).load(0.3, 20).oscillate(0.05, 60);
      if (unloading) {
        course.oscillate(0.05, 40, 0.87).level(0.0, 200);
      } else {
        course.level(0.34, 700);
      }
      const std::vector<Seen> whole = events_in(course.values());
      ASSERT_EQ(whole.size(), 2U);
      const base::ScanIndex first = whole[0].scan - (kStartDwell - 1) - kPreTrigger;
      const std::vector<double> record(course.values().begin() + first,
                                       course.values().begin() + whole[1].scan + 1);
      EXPECT_EQ(events_in(record, first), whole) << seed << " unloading " << unloading;
    }
  }
}

TEST(Segmenter, RefusesSettingsThatMakeNoSense) {
  const auto refused = [](auto change) {
    SegmenterSettings settings;
    change(settings);
    EXPECT_THROW(Segmenter{settings}, std::invalid_argument);
  };
  refused([](SegmenterSettings& s) { s.scan_rate_Hz = 0.0; });
  refused([](SegmenterSettings& s) { s.scan_rate_Hz = std::nan(""); });
  refused([](SegmenterSettings& s) { s.start_dwell_s = 0.0; });
  refused([](SegmenterSettings& s) { s.unload_dwell_s = -1.0; });
  refused([](SegmenterSettings& s) { s.no_motion_dwell_s = 0.0; });
  refused([](SegmenterSettings& s) { s.pre_trigger_s = -0.1; });
  refused([](SegmenterSettings& s) { s.end_coefficient = s.start_coefficient; });
  refused([](SegmenterSettings& s) { s.end_coefficient = -0.01; });
}

}  // namespace
}  // namespace stickslip::pipeline
