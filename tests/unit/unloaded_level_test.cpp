// When is a force the unloaded cell? Small zeros that are off must not hide tests, and loads must not pass
// for zeros.

#include "core/pipeline/unloaded_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "core/pipeline/segmenter.hpp"

namespace stickslip::pipeline {
namespace {

constexpr double kLevelRate_Hz = 350.0;
constexpr double kLevelNoise = 0.001;

class Force {
 public:
  Force& stay(double level, double seconds) { return slide(level, level, seconds); }
  Force& slide(double from, double to, double seconds) {
    const int count = static_cast<int>(seconds * kLevelRate_Hz);
    for (int k = 0; k < count; ++k) scans.push_back(from + (to - from) * k / count + noise_(engine_));
    return *this;
  }
  /// A pull of stick-slip above `zero`, and back to `after`.
  Force& pull(double zero, double after, double seconds = 2.0) {
    slide(zero, zero + 0.35, 0.2);
    const int count = static_cast<int>(seconds * kLevelRate_Hz);
    for (int k = 0; k < count; ++k) {
      const double phase = std::fmod(k, 18.0) / 18.0;
      scans.push_back(zero + (phase < 0.7 ? 0.25 + 0.1 * phase / 0.7 : 0.35 - 0.1 * (phase - 0.7) / 0.3) +
                      noise_(engine_));
    }
    return slide(zero + 0.3, after, 0.05);
  }

  std::vector<double> scans;

 private:
  std::mt19937_64 engine_{7};
  std::normal_distribution<double> noise_{0.0, kLevelNoise};
};

std::optional<double> latest_quiet(const Force& force) {
  UnloadedLevel level{kLevelRate_Hz, UnloadedLevel::kQuiet_s, 0.0};
  std::optional<double> found;
  for (const double scan : force.scans) {
    level.add(scan);
    if (level.news()) found = level.news();
  }
  return level.quiet() ? found : std::nullopt;
}

struct Decisions {
  int begun = 0;
  int ended = 0;
  std::optional<double> level;
  bool ready = false;
};

Decisions decisions_on(const Force& force) {
  Segmenter segmenter{SegmenterSettings{}};
  Decisions course;
  base::ScanIndex index = 0;
  for (const double scan : force.scans) {
    const Segmenter::Event event = segmenter.observe(index++, scan);
    if (event == Segmenter::Event::kTestStarts) ++course.begun;
    if (event == Segmenter::Event::kUnloaded || event == Segmenter::Event::kNoRelativeMotion) ++course.ended;
  }
  course.level = segmenter.unloaded_level();
  course.ready = segmenter.ready();
  return course;
}

TEST(UnloadedLevel, AQuietForceIsFoundAtItsLevel) {
  const auto level = latest_quiet(Force{}.stay(0.04, 3.0));
  ASSERT_TRUE(level);
  // Four medians of 44 scans: 0.001 · √(π/2/176) = 0.0001.
  EXPECT_NEAR(*level, 0.04, 0.0005);
}

TEST(UnloadedLevel, LoadingIsNotQuiet) {
  EXPECT_FALSE(latest_quiet(Force{}.stay(0.0, 1.0).slide(0.0, 0.1, 2.0)));
}

TEST(UnloadedLevel, PullingIsNotQuiet) {
  Force force;
  force.stay(0.0, 1.0).pull(0.0, 0.3, 3.0);
  EXPECT_FALSE(latest_quiet(force));
}

TEST(UnloadedLevel, ALevelWithinTheSelfChecksLimitIsZeroItself) {
  EXPECT_EQ(UnloadedLevel::of_decisions(0.0025), 0.0);
  EXPECT_EQ(UnloadedLevel::of_decisions(-0.0025), 0.0);
  EXPECT_EQ(UnloadedLevel::of_decisions(0.003), 0.003);
}

TEST(UnloadedLevel, EachPullIsATestWhateverTheZero) {
  for (const double zero : {-0.07, -0.025, 0.0, 0.015, 0.025, 0.04, 0.049, 0.07, 0.09}) {
    Force force;
    force.stay(zero, 3.0);
    for (int k = 0; k < 3; ++k) force.pull(zero, zero).stay(zero, 3.0);
    const Decisions course = decisions_on(force);
    EXPECT_EQ(course.begun, 3) << zero;
    EXPECT_EQ(course.ended, 3) << zero;
    EXPECT_TRUE(course.ready) << zero;
    ASSERT_TRUE(course.level) << zero;
    EXPECT_NEAR(*course.level, zero, 0.0005);
  }
}

TEST(UnloadedLevel, AZeroThatMovesDuringATestEndsItAndIsFollowed) {
  for (const double after : {-0.05, 0.03, 0.07}) {
    Force force;
    force.stay(0.0, 3.0).pull(0.0, after).stay(after, 3.0).pull(after, 0.01).stay(0.01, 3.0);
    const Decisions course = decisions_on(force);
    EXPECT_EQ(course.begun, 2) << after;
    EXPECT_EQ(course.ended, 2) << after;
    EXPECT_NEAR(course.level.value_or(1.0), 0.01, 0.0005);
  }
}

TEST(UnloadedLevel, DriftIsFollowed) {
  Force force;
  force.stay(0.0, 2.0).slide(0.0, 0.08, 120.0).pull(0.08, 0.08).stay(0.08, 2.0);
  const Decisions course = decisions_on(force);
  EXPECT_EQ(course.begun, 1);
  EXPECT_EQ(course.ended, 1);
}

// Also on paper so slippery that its friction would do for a zero that is off.
TEST(UnloadedLevel, SlidingSteadilyIsNoEndAndNoLevel) {
  for (const double kinetic : {0.06, 0.09, 0.12, 0.2, 0.3}) {
    Force force;
    force.stay(0.0, 2.0).slide(0.0, kinetic + 0.02, 0.2).stay(kinetic, 60.0);
    const Decisions course = decisions_on(force);
    EXPECT_EQ(course.begun, 1) << kinetic;
    EXPECT_EQ(course.ended, 0) << kinetic;
    EXPECT_NEAR(course.level.value_or(1.0), 0.0, 0.0005);
  }
}

TEST(UnloadedLevel, AfterALoadAThirdOfItIsUnloadedAndNoMore) {
  EXPECT_TRUE(UnloadedLevel::fits_after(0.049, 0.15, 0.0));
  EXPECT_FALSE(UnloadedLevel::fits_after(0.051, 0.15, 0.0));
  // Above the level before.
  EXPECT_TRUE(UnloadedLevel::fits_after(0.07, 0.15, 0.04));
  EXPECT_FALSE(UnloadedLevel::fits_after(0.08, 0.15, 0.04));
  EXPECT_FALSE(UnloadedLevel::fits_after(0.11, 1.0, 0.0)) << "friction is higher than that";
}

TEST(UnloadedLevel, ALoadThatIsThereFromTheFirstScanBeginsATest) {
  EXPECT_EQ(decisions_on(Force{}.stay(0.15, 2.0)).begun, 1);
  EXPECT_EQ(decisions_on(Force{}.stay(0.07, 2.0)).begun, 0) << "a zero that is off";
}

TEST(UnloadedLevel, TheLevelAfterATestIsThatOfItsLastQuietScans) {
  for (const double after : {0.0, 0.01, -0.05, 0.07}) {
    Force force;
    force.stay(0.0, 3.0).pull(0.0, after).stay(after, 3.0);
    Segmenter segmenter{SegmenterSettings{}};
    base::ScanIndex index = 0;
    for (const double scan : force.scans) {
      if (segmenter.observe(index++, scan) == Segmenter::Event::kUnloaded) break;
    }
    ASSERT_TRUE(segmenter.level_after()) << after;
    EXPECT_NEAR(*segmenter.level_after(), after, 0.001);
  }
}

/// A stretch at 350 Hz: four quarters of 43 scans.
constexpr int kLevelQuarter = 43;

/// Share of many stretches that are quiet. \param force  of the scan within the stretch.
template <typename Course>
double quiet_share(const Course& course, double noise, double step = 0.0) {
  constexpr int kStretches = 200;
  std::mt19937_64 engine{11};
  std::normal_distribution<double> normal;
  int quiet = 0;
  for (int i = 0; i < kStretches; ++i) {
    UnloadedLevel level{kLevelRate_Hz, UnloadedLevel::kQuiet_s, step};
    for (int k = 0; k < 4 * kLevelQuarter; ++k) level.add(course(k) + noise * normal(engine));
    quiet += level.quiet() ? 1 : 0;
  }
  return static_cast<double>(quiet) / kStretches;
}

TEST(UnloadedLevel, MediansOfAQuietForceDifferBySixStandardErrorsAtMost) {
  // Of 43 scans a median has √(π/2/43) σ. The range of four is 2 of these by noise; steps of 3 and of 1 a
  // quarter make it 9 ± 1.4 and 3.6 ± 1.
  const double error = kLevelNoise * std::sqrt(0.5 * std::numbers::pi / kLevelQuarter);
  const auto stairs = [error](double height) {
    return [=](int k) { return height * error * (k / kLevelQuarter); };
  };
  EXPECT_LT(quiet_share(stairs(3.0), kLevelNoise), 0.1);
  EXPECT_GT(quiet_share(stairs(1.0), kLevelNoise), 0.9);
}

TEST(UnloadedLevel, OneScanInTwentyMayLieBeyondFourStandardDeviations) {
  // Every tenth or every thirtieth scan is off by so many standard deviations.
  const auto spikes = [](int every, double sigmas) {
    return [=](int k) { return k % every == 0 ? sigmas * kLevelNoise : 0.0; };
  };
  EXPECT_LT(quiet_share(spikes(10, 6.5), kLevelNoise), 0.1);
  EXPECT_LT(quiet_share(spikes(10, 50.0), kLevelNoise), 0.1);
  EXPECT_GT(quiet_share(spikes(30, 50.0), kLevelNoise), 0.9);
  EXPECT_GT(quiet_share(spikes(10, 1.5), kLevelNoise), 0.9);
}

TEST(UnloadedLevel, LevelBetweenTwoCodesIsQuiet) {
  // Each quarter is read as the one code or as the other, without noise; two codes apart is a change.
  constexpr double kStep = 0.002;
  const auto codes = [](double steps) {
    return [=](int k) { return k / kLevelQuarter % 2 == 0 ? 0.0 : steps * kStep; };
  };
  EXPECT_EQ(quiet_share(codes(1.0), 0.0, kStep), 1.0);
  EXPECT_EQ(quiet_share(codes(2.0), 0.0, kStep), 0.0);
}

TEST(UnloadedLevel, TenthOfTheSelfChecksLimitIsQuietWithoutNoise) {
  const auto stairs = [](double range) { return [=](int k) { return range * (k / kLevelQuarter) / 3.0; }; };
  EXPECT_EQ(quiet_share(stairs(0.99 * 0.1 * UnloadedLevel::kNearest), 0.0), 1.0);
  EXPECT_EQ(quiet_share(stairs(1.01 * 0.1 * UnloadedLevel::kNearest), 0.0), 0.0);
}

TEST(UnloadedLevel, ExcursionsThatFillLessThanHalfAreNotQuiet) {
  Force force;
  for (int k = 0; k < 30; ++k) force.stay(0.0, 60 / kLevelRate_Hz).slide(0.0, 0.05, 30 / kLevelRate_Hz);
  EXPECT_FALSE(latest_quiet(force));
}

}  // namespace
}  // namespace stickslip::pipeline
