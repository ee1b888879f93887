#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/wording.hpp"
#include "core/sim/belt.hpp"
#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {

using base::Dimension;
using base::Limits;
using base::Settings;

namespace {

// Limits of sense, not of the method: a value outside is taken for a slip of the pen.
constexpr double kShortestTimeConstant_s = 1e-6;
constexpr double kLargestJerk_m_per_s3 = 1e6;
constexpr double kLongestSlack_m = 1.0;
constexpr double kLargestDrift = 100.0;
constexpr double kLongestTravel_m = 1e9;

constexpr std::array<std::string_view, 3> kShapes{"speed_ramp", "exponential_start", "jerk_limited_start"};

ConstantSpeed read_constant_speed(Settings effect) {
  const Limits duration = Limits::between(0.0, kLongestPhase_s);
  const Limits speed = Limits::above_up_to(0.0, kFastestBelt_m_per_s);
  ConstantSpeed test;
  test.idle_s = effect.quantity("idle", Dimension::kTime, duration);
  test.pull_speed_m_per_s = effect.quantity("pull_speed", Dimension::kSpeed, speed);
  test.pull_s = effect.quantity("pull", Dimension::kTime, Limits::above_up_to(0.0, kLongestPhase_s));
  test.stop_s = effect.quantity("stop", Dimension::kTime, duration);
  test.return_speed_m_per_s = effect.quantity("return_speed", Dimension::kSpeed, speed);
  test.return_s = effect.quantity("return", Dimension::kTime, duration);
  test.rest_s = effect.quantity("rest", Dimension::kTime, duration);
  return test;
}

void read_shape_of_pull(Settings effects, Scene& scene) {
  std::vector<std::string_view> listed;
  for (const std::string_view shape : kShapes) {
    if (lists(effects, shape)) listed.push_back(shape);
  }
  if (listed.empty()) return;
  if (listed.size() > 1) {
    effects.refuse(listed[1], fmt::format("must not stand beside {}: both shape the pull", listed[0]));
  }
  if (!scene.constant_speed) {
    effects.refuse(listed[0], "needs [effects.constant_speed], whose pull it shapes");
    return;
  }
  Settings effect = effects.table(listed[0]);
  if (listed[0] == "speed_ramp") {
    scene.speed_ramp =
        SpeedRamp{effect.quantity("to", Dimension::kSpeed, Limits::between(0.0, kFastestBelt_m_per_s))};
  } else if (listed[0] == "exponential_start") {
    scene.exponential_start = ExponentialStart{effect.quantity(
        "time_constant", Dimension::kTime, Limits::between(kShortestTimeConstant_s, kLongestPhase_s))};
  } else {
    const double jerk =
        effect.quantity("jerk", Dimension::kJerk, Limits::above_up_to(0.0, kLargestJerk_m_per_s3));
    if (!(jerk > 0.0)) return;
    scene.jerk_limited_start = JerkLimitedStart{jerk};
    const ConstantSpeed& test = *scene.constant_speed;
    if (2.0 * std::sqrt(test.pull_speed_m_per_s / jerk) > test.pull_s && test.pull_s > 0.0) {
      const double least = 4.0 * test.pull_speed_m_per_s / (test.pull_s * test.pull_s);
      effect.refuse("jerk", fmt::format("must be at least {}, or the pull is over before it has its speed",
                                        base::format_quantity(least, Dimension::kJerk)));
    }
  }
}

PiecewiseSpeed read_piecewise_speed(Settings effect) {
  PiecewiseSpeed profile;
  double before_s = 0.0;
  for (Settings& point : effect.tables("points")) {
    const double at_s = point.quantity("at", Dimension::kTime, Limits::between(0.0, kLongestPhase_s));
    if (at_s < before_s) {
      point.refuse("at", fmt::format("must not be before the point before it, at {}",
                                     base::format_quantity(before_s, Dimension::kTime)));
    }
    before_s = std::max(before_s, at_s);
    profile.points.push_back(
        {before_s, point.quantity("speed", Dimension::kSpeed,
                                  Limits::between(-kFastestBelt_m_per_s, kFastestBelt_m_per_s))});
  }
  if (profile.points.empty())
    effect.refuse("points", "must list points, each written as {at = \"2 s\", speed = \"12 in/min\"}");
  return profile;
}

/// "10 s" or "0.1 m".
void read_over(Settings& effect, KineticDrift& drift) {
  drift.scale = 1.0;
  const std::string text = effect.text("over");
  if (text.empty()) return;
  const auto time_s = base::parse_quantity(text, Dimension::kTime);
  const auto travel_m = base::parse_quantity(text, Dimension::kLength);
  if (!time_s && !travel_m) {
    effect.refuse("over", "must be a time such as \"10 s\" or a belt travel such as \"0.1 m\"");
    return;
  }
  drift.over = time_s ? KineticDrift::Over::kTime : KineticDrift::Over::kBeltTravel;
  const double scale = time_s ? *time_s : *travel_m;
  const double longest = time_s ? kLongestPhase_s : kLongestTravel_m;
  if (!(scale > 0.0 && scale <= longest)) {
    effect.refuse(
        "over", fmt::format("must be above 0 and at most {}",
                            base::format_quantity(longest, time_s ? Dimension::kTime : Dimension::kLength)));
    return;
  }
  drift.scale = scale;
}

}  // namespace

void read_belt_effects(Settings scene_table, Settings effects, Scene& scene) {
  if (lists(effects, "constant_speed")) {
    scene.constant_speed = read_constant_speed(effects.table("constant_speed"));
    scene.duration_s = scene.constant_speed->duration_s();
  } else {
    scene.duration_s =
        scene_table.quantity("duration", Dimension::kTime, Limits::above_up_to(0.0, kLongestPhase_s));
  }
  read_shape_of_pull(effects, scene);
  if (lists(effects, "piecewise_speed")) {
    if (scene.constant_speed) {
      effects.refuse("piecewise_speed", "must not stand beside constant_speed: both say how the belt moves");
    }
    PiecewiseSpeed profile = read_piecewise_speed(effects.table("piecewise_speed"));
    if (!profile.points.empty()) scene.piecewise_speed = std::move(profile);
  }
  if (lists(effects, "startup_slack")) {
    scene.startup_slack_m =
        effects.table("startup_slack")
            .quantity("length", Dimension::kLength, Limits::above_up_to(0.0, kLongestSlack_m));
    if (!scene.one_way_coupling)
      effects.refuse("startup_slack",
                     "needs [effects.one_way_coupling]: without it a coupling is never slack");
  }
}

void read_kinetic_drift(Settings effects, Scene& scene) {
  if (!lists(effects, "kinetic_drift")) return;
  constexpr std::array<std::pair<std::string_view, KineticDrift::Form>, 2> kCourses{
      {{"linear", KineticDrift::Form::kLinear}, {"exponential", KineticDrift::Form::kExponential}}};
  Settings effect = effects.table("kinetic_drift");
  KineticDrift drift;
  drift.change =
      effect.quantity("change", Dimension::kDimensionless, Limits::between(-kLargestDrift, kLargestDrift));
  drift.form = effect.choice<KineticDrift::Form>("course", kCourses, KineticDrift::Form::kLinear);
  read_over(effect, drift);
  scene.kinetic_drift = drift;

  // f changes in one direction, so that it is least at an end of what it goes through.
  std::pair<double, double> range{0.0, scene.duration_s};
  if (drift.over == KineticDrift::Over::kBeltTravel) {
    Scene belt_only = scene;
    belt_only.kinetic_drift.reset();
    range = belt_travel_range_m(motion_of(belt_only).belt, scene.duration_s);
  }
  for (const double x : {range.first, range.second}) {
    const double factor = drift_factor(drift, x);
    if (factor >= 0.0) continue;
    // f = 1 + change · g
    const double limit = drift.change / (1.0 - factor);
    effect.refuse("change", fmt::format("takes mu_k = {} down to {:.3g} within the scene; must be {} {:.6g}",
                                        scene.mu_k, scene.mu_k * factor,
                                        drift.change < 0.0 ? "at least" : "at most", limit));
    break;
  }
}

}  // namespace stickslip::sim
