// What belt and drift prescribe for a piece of the motion, in units of the coefficient.
#include <cmath>
#include <limits>

#include "core/sim/belt.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::sim {

namespace {

/// Where two segments meet at one speed, they differ by roundings: of a few terms each.
constexpr double kJoint = 32.0 * std::numeric_limits<double>::epsilon();

}  // namespace

void Propagator::next_segment() {
  const double rate_per_speed = omega0_squared_ / motion_.gravity_m_per_s2;
  const double length_s = segment_end_.periods_since(segment_start_) / scan_rate_Hz_;
  const double rate_before = plain_ ? belt_rate_ : segment_rate_.value(segment_ == 0 ? 0.0 : length_s);
  const double size_before = plain_ ? std::abs(belt_rate_) : segment_rate_.magnitude(length_s);
  if (!plain_ && segment_ > 0) segment_travel_ += segment_rate_.integral().value(length_s);

  halt_when_unloaded_ = false;
  belt_rate_ = 0.0;
  belt_slope_ = 0.0;
  segment_start_ = segment_end_;
  segment_rate_ = {};
  if (segment_ == motion_.belt.size()) {
    segment_end_ = kForEver;
    plain_ = !motion_.kinetic_drift;
  } else {
    const BeltSegment& segment = motion_.belt[segment_++];
    const ExponentialPolynomial speed = belt_speed(segment);
    plain_ = speed.is_constant() && !motion_.kinetic_drift;
    belt_rate_ = rate_per_speed * speed.value(0.0);
    segment_rate_ = speed.scaled(rate_per_speed);
    halt_when_unloaded_ = segment.halt_when_unloaded;
    segment_end_ = segment_end_.later(segment.duration_s * scan_rate_Hz_);
  }
  look_ahead();
  const double rounding = kJoint * (size_before + segment_rate_.magnitude(0.0));
  joins_smoothly_ = std::abs(belt_rate_ - rate_before) <= rounding;
}

void Propagator::look_ahead() {
  drift_factor_ = 1.0;
  if (plain_) return;
  const double since_s = start_.periods_since(segment_start_) / scan_rate_Hz_;
  rate_ = segment_rate_.later(since_s);
  way_ = rate_.integral();
  belt_rate_ = rate_.value(0.0);
  belt_slope_ = rate_.derivative().value(0.0);
  factor_ = drift_course(since_s);
  drift_factor_ = factor_.value(0.0);
}

void Propagator::halt_belt() {
  if (!plain_) {
    const double since_s = start_.periods_since(segment_start_) / scan_rate_Hz_;
    segment_travel_ += segment_rate_.integral().value(since_s);
  }
  halt_when_unloaded_ = false;
  belt_rate_ = 0.0;
  belt_slope_ = 0.0;
  segment_start_ = start_;
  segment_rate_ = {};
  look_ahead();
}

ExponentialPolynomial Propagator::drift_course(double piece_after_segment_s) const {
  if (!motion_.kinetic_drift) return ExponentialPolynomial{1.0};
  const KineticDrift& drift = *motion_.kinetic_drift;
  const bool linear = drift.form == KineticDrift::Form::kLinear;
  if (drift.over == KineticDrift::Over::kTime) {
    const double now_s = start_.periods_since({}) / scan_rate_Hz_;
    ExponentialPolynomial factor{sim::drift_factor(drift, now_s)};
    if (linear) {
      factor.add_power(1, drift.change / drift.scale);
    } else {
      factor.add_decay(1.0 / drift.scale, 1, drift.change / drift.scale * std::exp(-now_s / drift.scale));
    }
    return factor;
  }
  const double length_per_rate = motion_.gravity_m_per_s2 / omega0_squared_;
  const double now_m =
      length_per_rate * (segment_travel_ + segment_rate_.integral().value(piece_after_segment_s));
  ExponentialPolynomial factor{sim::drift_factor(drift, now_m)};
  if (linear) {
    factor += way_.scaled(drift.change / drift.scale * length_per_rate);
  } else {  // The speed is constant: has_closed_form().
    const double per_s = belt_rate_ * length_per_rate / drift.scale;
    factor.add_decay(per_s, 1, drift.change * per_s * std::exp(-now_m / drift.scale));
  }
  return factor;
}

bool Propagator::leaves_backwards() const {
  if (belt_rate_ != 0.0 || plain_) return belt_rate_ < 0.0;
  for (ExponentialPolynomial derivative = rate_.derivative();
       derivative.powers() > 0 || derivative.decays() > 0; derivative = derivative.derivative()) {
    const double slope = derivative.value(0.0);
    if (slope != 0.0) return slope < 0.0;
    if (derivative.powers() <= 1) break;
  }
  return false;
}

}  // namespace stickslip::sim
