// What must not change the numbers, and what no scene may ask for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/grazing.hpp"
#include "core/accuracy/reference.hpp"
#include "core/sim/numeric_solver.hpp"
#include "core/sim/propagator.hpp"
#include "core/sim/scene.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

constexpr std::size_t kScans = 3500;

/// 4 ε T max|c′| + 8 ε: exact_law_test.cpp; max|c′| of these scenes is below 12/s.
constexpr double kLaw = 4.0 * kEpsilon * 10.0 * 12.0 + 8.0 * kEpsilon;

TEST(Invariance, WaitingBeforeThePullOnlyShiftsTheTrace) {
  const sim::Motion motion = motion_at(1.3, 0.022);
  const std::vector<double> at_once = trace(motion, kRate_Hz, kScans);
  for (const double idle_s : {1.0, 1000.0, 1e7}) {
    sim::Motion waiting = motion;
    waiting.belt.insert(waiting.belt.begin(), sim::BeltSegment{idle_s, 0.0, false});
    sim::Propagator sled{waiting, kRate_Hz};
    sled.skip(static_cast<std::int64_t>(idle_s * kRate_Hz));
    std::vector<double> later(kScans);
    sled.next(later);
    EXPECT_LE(accuracy::largest_difference(at_once, later), kLaw) << idle_s;
  }
}

TEST(Invariance, SplittingARunChangesNoBit) {
  for (const double mu_s : {0.325, 0.35, 0.75}) {
    sim::Motion motion = motion_at(1.3, 0.022, mu_s, 0.30);
    motion.one_way_coupling = true;
    const std::vector<double> whole = trace(motion, kRate_Hz, kScans);
    for (const std::size_t first : {1U, 17U, 1751U}) {
      sim::Propagator sled{motion, kRate_Hz};
      std::vector<double> parts(kScans);
      sled.next(std::span{parts}.first(first));
      sled.next(std::span{parts}.subspan(first));
      EXPECT_EQ(whole, parts) << first;
      sim::Propagator late{motion, kRate_Hz};
      late.skip(static_cast<std::int64_t>(first));
      std::vector<double> rest(kScans - first);
      late.next(rest);
      EXPECT_TRUE(std::equal(rest.begin(), rest.end(), whole.begin() + static_cast<std::ptrdiff_t>(first)))
          << first;
    }
  }
}

struct SceneWords {
  std::string mass = "2331 g";
  std::string spring = "stiffness = \"36.8 N/mm\"";
  std::string speed = "12 in/min";
  std::string mu_s = "0.35";
  std::string mu_k = "0.30";
  std::string gravity = "9.80665 m/s^2";
  std::string damping = "0.022";
  std::string rate = "350 Hz";
  std::string pull = "10 s";
};

base::Result<sim::Scene> scene_of(const SceneWords& words) {
  return sim::parse_scene(
      fmt::format(
          "description = \"a test\"\nscan_rate = \"{}\"\n[tester]\nsled_mass = \"{}\"\ngravity = \"{}\"\n{}\n"
          "load_cell_gain = \"2 N/V\"\n[paper]\nmu_s = {}\nmu_k = {}\n[effects.damping]\n"
          "gamma_over_2omega = {}\n[effects.constant_speed]\nidle = \"0 s\"\npull_speed = \"{}\"\n"
          "pull = \"{}\"\nstop = \"0 s\"\nreturn_speed = \"1 m/s\"\nreturn = \"0 s\"\nrest = \"0 s\"\n",
          words.rate, words.mass, words.gravity, words.spring, words.mu_s, words.mu_k, words.damping,
          words.speed, words.pull),
      "scene.toml");
}

std::vector<double> trace_of(const SceneWords& words) {
  const base::Result<sim::Scene> scene = scene_of(words);
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
  return scene ? trace(sim::motion_of(*scene), kRate_Hz, kScans) : std::vector<double>(kScans);
}

// Only k/m enters. Twice of both leaves each bit of the quotient, ten times of both rounds it twice.
TEST(Invariance, HeavierSledOnAStifferCouplingMovesTheSame) {
  const std::vector<double> one = trace_of({});
  SceneWords twice;
  twice.mass = "4662 g";
  twice.spring = "stiffness = \"73.6 N/mm\"";
  EXPECT_EQ(one, trace_of(twice));
  SceneWords ten_times;
  ten_times.mass = "23.31 kg";
  ten_times.spring = "stiffness = \"368 N/mm\"";
  EXPECT_LE(accuracy::largest_difference(one, trace_of(ten_times)), 2.0 * kLaw);
}

// A unit is a factor, which rounds once: each of the three numbers that make up r and ω.
TEST(Invariance, UnitsAreWords) {
  SceneWords metric;
  metric.mass = "2.331 kg";
  metric.spring = "stiffness = \"36800 N/m\"";
  metric.speed = "5.08 mm/s";
  metric.pull = "10000 ms";
  EXPECT_LE(accuracy::largest_difference(trace_of({}), trace_of(metric)), 2.0 * kLaw);
}

// Hard case 9, defined: without friction nothing moves the sled, and a spring that nothing stretches reads 0.
TEST(Invariance, WithoutFrictionTheSledStaysBehind) {
  const sim::Motion motion = motion_at(1.0, 0.022, 0.0, 0.0);
  sim::Motion pulled = motion;
  pulled.belt = {{10.0, 0.00508, false}};
  for (const double c : trace(pulled, kRate_Hz, kScans)) ASSERT_EQ(c, 0.0);
  // S = K > 0 is steady sliding after one rise; the reference says so too.
  sim::Motion equal = motion_at(1.0, 0.022, 0.35, 0.30);
  equal.mu_s = equal.mu_k;
  std::vector<double> truth(kScans);
  accuracy::Reference{equal, kRate_Hz}.next(truth);
  EXPECT_LE(accuracy::largest_difference(trace(equal, kRate_Hz, kScans), truth), kLaw);
  EXPECT_NEAR(truth.back(), 0.30, 1e-9);
}

// Hard case 9, refused: by name, before anything is simulated.
TEST(Invariance, NonsenseInASceneIsRefused) {
  const auto refused = [](const SceneWords& words, const char* key) {
    const base::Result<sim::Scene> scene = scene_of(words);
    ASSERT_FALSE(scene) << key;
    EXPECT_NE(scene.error().message.find(key), std::string::npos) << scene.error().message;
  };
  ASSERT_TRUE(scene_of({}));
  refused({.mu_s = "0.29"}, "mu_s");  // S < K
  refused({.mu_s = "-0.35", .mu_k = "-0.36"}, "mu_s");
  for (const char* number : {"nan", "inf", "-inf", "-0.1"}) {
    refused({.mu_s = number}, "mu_s");
    refused({.mu_k = number}, "mu_k");
    refused({.damping = number}, "gamma_over_2omega");
  }
  for (const char* number : {"nan", "inf", "-1", "0"}) {
    refused({.mass = fmt::format("{} kg", number)}, "sled_mass");
    refused({.spring = fmt::format("stiffness = \"{} N/m\"", number)}, "stiffness");
    refused({.spring = fmt::format("frequency = \"{} Hz\"", number)}, "frequency");
    refused({.speed = fmt::format("{} m/s", number)}, "pull_speed");
    refused({.gravity = fmt::format("{} m/s^2", number)}, "gravity");
    refused({.rate = fmt::format("{} Hz", number)}, "scan_rate");
    refused({.pull = fmt::format("{} s", number)}, "pull");
  }
}

// Hard case 9 for who builds a motion without a scene: a contract, for either solver.
TEST(InvarianceDeathTest, NonsenseInAMotionBreaksTheContract) {
  const sim::Motion sound = accuracy::grazing_motion(0.022, 1.0);
  const auto breaks = [](const sim::Motion& motion) {
    EXPECT_DEATH(sim::Propagator(motion, 350.0), "contract broken");
    EXPECT_DEATH(sim::NumericSolver(motion, 350.0, 1e-6), "contract broken");
  };
  for (const double number :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    sim::Motion motion = sound;
    motion.mu_s = number;
    breaks(motion);
    motion = sound;
    motion.oscillator.gamma_per_s = number;
    breaks(motion);
    motion = sound;
    motion.gravity_m_per_s2 = number;
    breaks(motion);
  }
  sim::Motion motion = sound;
  motion.belt.front().speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  breaks(motion);
}

}  // namespace
}  // namespace stickslip::numeric
