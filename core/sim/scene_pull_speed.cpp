// The course of a scene's pull speed, as a test plan would say it.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/sim/belt.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sim {
namespace {

/// Lines that a curve is made of. A motor's rise 1 − e^(−t/τ), followed for kDecayTimes τ, bends most at its
/// start: there a line of h = τ/20 is off by (h/τ)²/8 of it; an S-curve by less.
constexpr int kLines = 240;
constexpr double kDecayTimes = 12.0;

bool is_line(const BeltSegment& segment) {
  return segment.jerk_m_per_s3 == 0.0 && segment.decaying_speed_m_per_s == 0.0;
}

void append(const BeltSegment& segment, double start_s, std::vector<model::SpeedPoint>& points) {
  const ExponentialPolynomial speed = belt_speed(segment);
  const auto add = [&](double t_s) { points.push_back({start_s + t_s, speed.value(t_s)}); };
  add(0.0);
  if (!is_line(segment)) {
    const bool decays = segment.decaying_speed_m_per_s != 0.0;
    const double curved_s =
        decays ? std::min(segment.duration_s, kDecayTimes * segment.time_constant_s) : segment.duration_s;
    for (int i = 1; i <= kLines; ++i) {
      const double t_s = curved_s * i / kLines;
      if (t_s < segment.duration_s) add(t_s);
    }
  }
  add(segment.duration_s);
}

}  // namespace

std::optional<model::PullSpeed> pull_speed_of(const Scene& scene) {
  // A steady pull needs no course: the stop after it is not a change of its speed.
  const bool steady =
      scene.constant_speed && !scene.speed_ramp && !scene.exponential_start && !scene.jerk_limited_start;
  if (steady) return std::nullopt;
  std::vector<model::SpeedPoint> points;
  double now_s = 0.0;
  for (const BeltSegment& segment : motion_of(scene).belt) {
    if (segment.halt_when_unloaded) break;
    const bool rests = segment.speed_m_per_s == 0.0 && segment.acceleration_m_per_s2 == 0.0 &&
                       segment.jerk_m_per_s3 == 0.0 && segment.decaying_speed_m_per_s == 0.0;
    if (points.empty() && rests) continue;
    if (segment.duration_s > 0.0) append(segment, now_s, points);
    now_s += segment.duration_s;
  }
  auto speed = model::PullSpeed::make(std::move(points));
  return speed && !speed->is_constant() ? speed : std::nullopt;
}

}  // namespace stickslip::sim
