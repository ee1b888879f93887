// Belts that change their speed, K that drifts, a coupling that is slack at first: the same physics by tiny
// steps and Coulomb's two sentences, without phases, events or closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using sim::BeltSegment;
using sim::KineticDrift;

constexpr double kScanRate_Hz = 500.0;

double belt_speed_of(const BeltSegment& segment, double t_s) {
  return segment.speed_m_per_s + segment.acceleration_m_per_s2 * t_s +
         segment.jerk_m_per_s3 * t_s * t_s / 2.0 +
         segment.decaying_speed_m_per_s * std::exp(-t_s / segment.time_constant_s);
}

constexpr double kStep_s = 1e-6;
constexpr int kStepsPerScan = 2000;

std::vector<double> stepped(const sim::Motion& motion, std::size_t count) {
  const double omega0_squared = motion.oscillator.omega0_squared();
  const double gamma = motion.oscillator.gamma_per_s;
  const double unit = omega0_squared / motion.gravity_m_per_s2;
  std::vector<double> coefficient;
  double x = -motion.startup_slack_m * unit;
  double v = motion.startup_slack_m > 0.0 ? unit * belt_speed_of(motion.belt.front(), 0.0) : 0.0;
  double travel_m = 0.0;
  std::size_t segment = 0;
  double segment_start_s = 0.0;
  bool halted = false;
  bool along = v == unit * belt_speed_of(motion.belt.front(), 0.0);
  for (std::int64_t step = 0; coefficient.size() < count; ++step) {
    const double now_s = static_cast<double>(step) * kStep_s;
    if (step % kStepsPerScan == 0) coefficient.push_back(motion.one_way_coupling ? std::fmax(x, 0.0) : x);
    bool joint = false;
    while (segment < motion.belt.size() &&
           now_s > segment_start_s + motion.belt[segment].duration_s - kStep_s / 2.0) {
      segment_start_s += motion.belt[segment++].duration_s;
      halted = false;
      joint = true;
    }
    const auto belt_at = [&](double t_s) {
      if (segment == motion.belt.size() || halted) return 0.0;
      return unit * belt_speed_of(motion.belt[segment], t_s - segment_start_s);
    };
    if (segment < motion.belt.size() && motion.belt[segment].halt_when_unloaded && x <= 0.0) halted = true;
    const double belt = belt_at(now_s);
    const double next_belt = belt_at(now_s + kStep_s);
    // The belt may round differently from itself.
    if (joint) along = std::abs(v - belt) < 1e-9;
    if (halted && belt != v) along = false;
    if (along) v = belt;
    double drift = 1.0;
    if (motion.kinetic_drift) {
      const KineticDrift& law = *motion.kinetic_drift;
      const double part = (law.over == KineticDrift::Over::kTime ? now_s : travel_m) / law.scale;
      drift += law.change * (law.form == KineticDrift::Form::kLinear ? part : 1.0 - std::exp(-part));
    }
    travel_m += (belt + next_belt) / 2.0 * kStep_s / unit;
    const double K = motion.mu_k * drift;
    const double S = K + motion.mu_s - motion.mu_k;
    const bool slack = motion.one_way_coupling && x < 0.0;
    const double spring = slack ? 0.0 : x;
    const double slope = (next_belt - belt) / kStep_s;
    const double damper = motion.damper_counts_at_onset && !slack ? gamma * belt / omega0_squared : 0.0;
    const double q = spring + slope / omega0_squared + damper;
    if (along && std::abs(q) <= S) {
      x += (belt + next_belt) / 2.0 * kStep_s;
      v = next_belt;
      continue;
    }
    const bool slower = along ? q > 0.0 : v < belt;
    const auto pull = [&](double at_x, double at_v) {
      return (slower ? 1.0 : -1.0) * omega0_squared * K -
             (slack ? 0.0 : omega0_squared * at_x + gamma * at_v);
    };
    const double middle_x = x + v * kStep_s / 2.0;
    const double middle_v = v + pull(x, v) * kStep_s / 2.0;
    const double next_v = v + pull(middle_x, middle_v) * kStep_s;
    x += middle_v * kStep_s;
    along = !along && (next_v - next_belt) * (v - belt) <= 0.0;
    v = along ? next_belt : next_v;
  }
  return coefficient;
}

/// Each event is found up to a step late, which shifts what follows by up to c′ · step ≈ 6e-5; sticking
/// forgets most of it before it can add up.
constexpr double kTolerance = 5e-4;

void expect_the_same(const sim::Motion& motion, const char* name) {
  constexpr std::size_t kScans = 600;
  const std::vector<double> reference = stepped(motion, kScans);
  const std::vector<double> exact = trace(motion, kScanRate_Hz, kScans);
  for (std::size_t i = 0; i < kScans; ++i) {
    ASSERT_NEAR(exact[i], reference[i], kTolerance) << name << " scan " << i;
  }
}

TEST(PropagatorBelt, AgreesWithTinySteps) {
  const BeltSegment idle{.duration_s = 0.05};
  for (const bool one_way : {false, true}) {
    for (const double damping : {0.022, 0.7}) {
      const auto expect = [&](const char* name, std::vector<BeltSegment> belt) {
        expect_the_same(on_belt(std::move(belt), damping, one_way), name);
      };
      expect("ramp up", {idle, {.duration_s = 2.0, .acceleration_m_per_s2 = 0.01}});
      expect("ramp down through zero",
             {idle, {.duration_s = 2.0, .speed_m_per_s = 0.006, .acceleration_m_per_s2 = -0.012}});
      expect(
          "jerk",
          {idle,
           {.duration_s = 0.2, .jerk_m_per_s3 = 0.2},
           {.duration_s = 0.2, .speed_m_per_s = 0.004, .acceleration_m_per_s2 = 0.04, .jerk_m_per_s3 = -0.2},
           {.duration_s = 1.0, .speed_m_per_s = 0.008}});
      expect("exponential start", {idle,
                                   {.duration_s = 2.0,
                                    .speed_m_per_s = kSpeed,
                                    .decaying_speed_m_per_s = -kSpeed,
                                    .time_constant_s = 0.15}});
      expect("hard brake that the sled overtakes",
             {{.duration_s = 0.4, .speed_m_per_s = 0.05},
              {.duration_s = 0.02, .speed_m_per_s = 0.05, .acceleration_m_per_s2 = -10.0},
              {.duration_s = 1.0, .speed_m_per_s = -0.15, .acceleration_m_per_s2 = 0.1}});
      expect("hard start", {idle,
                            {.duration_s = 0.01, .acceleration_m_per_s2 = 10.0},
                            {.duration_s = 0.05, .speed_m_per_s = 0.1, .acceleration_m_per_s2 = -1.8},
                            {.duration_s = 1.0, .speed_m_per_s = 0.01, .acceleration_m_per_s2 = -0.01}});
      expect("return that slows down, halting", {{.duration_s = 0.5, .speed_m_per_s = kSpeed},
                                                 {.duration_s = 0.2},
                                                 {.duration_s = 0.4,
                                                  .speed_m_per_s = -0.004,
                                                  .halt_when_unloaded = true,
                                                  .acceleration_m_per_s2 = 0.001}});
    }
  }
}

TEST(PropagatorBelt, StartUpSlackAgreesWithTinySteps) {
  for (const double acceleration : {0.01, 2.0, 10.0}) {
    sim::Motion motion = on_belt({{.duration_s = 0.05},
                                  {.duration_s = 0.1, .acceleration_m_per_s2 = acceleration},
                                  {.duration_s = 1.0, .speed_m_per_s = 0.01}},
                                 0.022, true);
    motion.startup_slack_m = 1e-4;
    expect_the_same(motion, "slack");
  }
}

TEST(KineticDrift, AgreesWithTinySteps) {
  for (const auto course : {KineticDrift::Form::kLinear, KineticDrift::Form::kExponential}) {
    for (const auto over : {KineticDrift::Over::kTime, KineticDrift::Over::kBeltTravel}) {
      for (const double change : {-0.5, 0.5}) {
        for (const double mu_s : {0.31, 0.35, 0.7}) {
          sim::Motion motion =
              on_belt({{.duration_s = 0.1},
                       {.duration_s = 0.8, .speed_m_per_s = kSpeed},
                       {.duration_s = 0.1},
                       {.duration_s = 0.2, .speed_m_per_s = -kSpeed, .halt_when_unloaded = true}},
                      0.022, true);
          motion.mu_s = mu_s;
          motion.kinetic_drift =
              KineticDrift{course, over, change, over == KineticDrift::Over::kTime ? 1.3 : 0.006};
          ASSERT_TRUE(has_closed_form(motion));
          expect_the_same(motion, "drift");
        }
      }
    }
  }
}

TEST(KineticDrift, OverTheTravelOfABeltThatChangesItsSpeed) {
  sim::Motion motion = on_belt(
      {{.duration_s = 0.5, .acceleration_m_per_s2 = 0.01},
       {.duration_s = 2.0, .speed_m_per_s = 0.002, .decaying_speed_m_per_s = 0.003, .time_constant_s = 0.2}});
  motion.kinetic_drift =
      KineticDrift{KineticDrift::Form::kLinear, KineticDrift::Over::kBeltTravel, 0.6, 0.004};
  ASSERT_TRUE(has_closed_form(motion));
  expect_the_same(motion, "linear");
  motion.kinetic_drift->form = KineticDrift::Form::kExponential;
  EXPECT_FALSE(has_closed_form(motion));
  motion.belt = {{.duration_s = 2.0, .speed_m_per_s = kSpeed}};
  EXPECT_TRUE(has_closed_form(motion));
}

}  // namespace
}  // namespace stickslip::numeric
