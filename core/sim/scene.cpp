#include "core/sim/scene.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stickslip::sim {

namespace {

std::vector<BeltSegment> pull_segments(const Scene& scene) {
  const double V = scene.constant_speed->pull_speed_m_per_s;
  const double pull_s = scene.constant_speed->pull_s;
  BeltSegment pull{.duration_s = pull_s, .speed_m_per_s = V};
  if (scene.speed_ramp) {
    pull.acceleration_m_per_s2 = (scene.speed_ramp->to_m_per_s - V) / pull_s;
  } else if (scene.exponential_start) {
    pull.decaying_speed_m_per_s = -V;
    pull.time_constant_s = scene.exponential_start->time_constant_s;
  } else if (scene.jerk_limited_start) {
    const double jerk = scene.jerk_limited_start->jerk_m_per_s3;
    const double half_s = std::sqrt(V / jerk);
    return {{.duration_s = half_s, .jerk_m_per_s3 = jerk},
            {.duration_s = half_s,
             .speed_m_per_s = V / 2.0,
             .acceleration_m_per_s2 = jerk * half_s,
             .jerk_m_per_s3 = -jerk},
            {.duration_s = pull_s - 2.0 * half_s, .speed_m_per_s = V}};
  }
  return {pull};
}

std::vector<BeltSegment> piecewise_segments(const Scene& scene) {
  const std::vector<PiecewiseSpeed::Point>& points = scene.piecewise_speed->points;
  std::vector<BeltSegment> belt{{.duration_s = points.front().at_s}};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double duration_s = points[i + 1].at_s - points[i].at_s;
    if (!(duration_s > 0.0)) continue;
    belt.push_back(
        {.duration_s = duration_s,
         .speed_m_per_s = points[i].speed_m_per_s,
         .acceleration_m_per_s2 = (points[i + 1].speed_m_per_s - points[i].speed_m_per_s) / duration_s});
  }
  const double rest_s = scene.duration_s - points.back().at_s;
  if (rest_s > 0.0) belt.push_back({.duration_s = rest_s, .speed_m_per_s = points.back().speed_m_per_s});
  return belt;
}

}  // namespace

Motion motion_of(const Scene& scene) {
  Motion motion;
  motion.oscillator = scene.oscillator;
  motion.mu_s = scene.mu_s;
  motion.mu_k = scene.mu_k;
  motion.gravity_m_per_s2 = scene.gravity_m_per_s2;
  motion.paper = scene.paper;
  motion.damper_counts_at_onset = scene.onset_convention == OnsetConvention::kSpringAndDamper;
  motion.one_way_coupling = scene.one_way_coupling;
  if (scene.velocity_dependence_s_per_m || scene.stribeck) {
    VelocityDependence& law = motion.velocity_dependence.emplace();
    law.per_speed_s_per_m = scene.velocity_dependence_s_per_m.value_or(0.0);
    if (scene.stribeck) {
      law.stribeck_rise = scene.stribeck->rise;
      law.stribeck_speed_m_per_s = scene.stribeck->speed_m_per_s;
      law.stribeck_exponent = scene.stribeck->exponent;
    }
  }
  motion.rate_and_state = scene.rate_and_state;
  motion.startup_slack_m = scene.startup_slack_m.value_or(0.0);
  motion.kinetic_drift = scene.kinetic_drift;
  if (scene.constant_speed) {
    const ConstantSpeed& test = *scene.constant_speed;
    motion.belt = {{.duration_s = test.idle_s}};
    const std::vector<BeltSegment> pull = pull_segments(scene);
    motion.belt.insert(motion.belt.end(), pull.begin(), pull.end());
    motion.belt.push_back({.duration_s = test.stop_s});
    motion.belt.push_back({.duration_s = test.return_s,
                           .speed_m_per_s = -test.return_speed_m_per_s,
                           .halt_when_unloaded = true});
  } else if (scene.piecewise_speed) {
    motion.belt = piecewise_segments(scene);
  }
  return motion;
}

std::optional<Pull> pull_of(const Scene& scene) {
  if (scene.constant_speed) {
    const ConstantSpeed& test = *scene.constant_speed;
    return Pull{test.idle_s, test.idle_s + test.pull_s};
  }
  if (!scene.piecewise_speed) return std::nullopt;
  std::optional<Pull> pull;
  double start_s = 0.0;
  for (const BeltSegment& segment : motion_of(scene).belt) {
    const double end_s = start_s + segment.duration_s;
    const bool moves = segment.speed_m_per_s != 0.0 || segment.acceleration_m_per_s2 != 0.0;
    if (moves) pull = Pull{pull ? pull->start_s : start_s, end_s};
    start_s = end_s;
  }
  if (pull) pull->end_s = std::min(pull->end_s, scene.duration_s);
  return pull;
}

std::optional<double> steady_pull_speed_m_per_s(const Scene& scene) {
  if (!scene.constant_speed || scene.speed_ramp) return std::nullopt;
  return scene.constant_speed->pull_speed_m_per_s;
}

double true_scan_rate_Hz(const Scene& scene, double scan_rate_Hz) noexcept {
  return scene.clock_rate_error ? scan_rate_Hz * (1.0 + scene.clock_rate_error->relative) : scan_rate_Hz;
}

std::int64_t scan_count(const Scene& scene, double scan_rate_Hz) noexcept {
  return static_cast<std::int64_t>(std::ceil(scene.duration_s * true_scan_rate_Hz(scene, scan_rate_Hz)));
}

}  // namespace stickslip::sim
