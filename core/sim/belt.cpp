#include "core/sim/belt.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "core/sim/first_rise.hpp"

namespace stickslip::sim {

ExponentialPolynomial belt_speed(const BeltSegment& segment) {
  ExponentialPolynomial speed{segment.speed_m_per_s + segment.decaying_speed_m_per_s};
  speed.add_power(1, segment.acceleration_m_per_s2);
  speed.add_power(2, segment.jerk_m_per_s3 / 2.0);
  if (segment.decaying_speed_m_per_s != 0.0) {
    STICKSLIP_EXPECTS(segment.time_constant_s > 0.0);
    // d e^(−t/τ) = d − (d/τ) φ₁: a motor that starts from rest does so without a rounding.
    speed.add_decay(1.0 / segment.time_constant_s, 1,
                    -segment.decaying_speed_m_per_s / segment.time_constant_s);
  }
  return speed;
}

double belt_speed_m_per_s(const std::vector<BeltSegment>& belt, double time_s) {
  for (const BeltSegment& segment : belt) {
    if (time_s < segment.duration_s) return belt_speed(segment).value(time_s);
    time_s -= segment.duration_s;
  }
  return 0.0;
}

std::pair<double, double> belt_travel_range_m(const std::vector<BeltSegment>& belt, double duration_s) {
  double travel = 0.0;
  double least = 0.0;
  double most = 0.0;
  double left_s = duration_s;
  for (const BeltSegment& segment : belt) {
    const double end_s = std::min(segment.duration_s, left_s);
    const ExponentialPolynomial speed = belt_speed(segment);
    const ExponentialPolynomial way = speed.integral();
    // The way turns where the speed changes its sign: at most once in each direction.
    for (const double sign : {1.0, -1.0}) {
      const Curve forwards{{}, speed.scaled(sign)};
      const auto turn_s = first_rise_s(forwards, 0.0, end_s, Touch::kDoesNot);
      if (!turn_s) continue;
      least = std::min(least, travel + way.value(*turn_s));
      most = std::max(most, travel + way.value(*turn_s));
    }
    travel += way.value(end_s);
    least = std::min(least, travel);
    most = std::max(most, travel);
    left_s -= end_s;
    if (!(left_s > 0.0)) break;
  }
  return {least, most};
}

double drift_factor(const KineticDrift& drift, double x) {
  const double part = x / drift.scale;
  return 1.0 + drift.change * (drift.form == KineticDrift::Form::kLinear ? part : -std::expm1(-part));
}

}  // namespace stickslip::sim
