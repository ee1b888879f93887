// How each piece of the motion ends: the earliest of the events that its phase can meet.
#include <algorithm>
#include <cmath>

#include "core/sim/bracket.hpp"
#include "core/sim/first_rise.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::sim {

using model::SlipWaveform;

namespace {

/// Without the offset K: what is left is a solution of the homogeneous equation.
SlipWaveform homogeneous(const SlipWaveform& slip, double sign) {
  return {0.0, sign * slip.D, sign * slip.r, slip.oscillator};
}

/// c′ as a function of its own: from c′(0) with the slope c″(0).
SlipWaveform derivative(const SlipWaveform& slip, double sign) {
  const double slope = -slip.oscillator.gamma_per_s * slip.r - slip.oscillator.omega0_squared() * slip.D;
  return {0.0, sign * slip.r, sign * slope, slip.oscillator};
}

}  // namespace

void Propagator::offer(Ending ending, std::optional<double> t_s) {
  if (!t_s) return;
  const double duration_s = std::fmax(*t_s, 0.0);
  if (ending_ != Ending::kNever && !(duration_s < duration_s_)) return;
  const ScanTime end = start_.later(duration_s * scan_rate_Hz_);
  if (end > segment_end_) return;
  ending_ = ending;
  duration_s_ = duration_s;
  end_ = end;
}

void Propagator::offer_giving_way(std::optional<double> t_s, double side) {
  const double before_s = ending_ == Ending::kGivesWay ? duration_s_ : -1.0;
  offer(Ending::kGivesWay, t_s);
  if (ending_ == Ending::kGivesWay && duration_s_ != before_s) gives_way_to_ = side;
}

void Propagator::plan_end() {
  ending_ = Ending::kNever;
  switch (phase_) {
    case Phase::kStick:
      plan_stick_end();
      break;
    case Phase::kSlower:
    case Phase::kFaster:
      plan_slip_end();
      break;
    case Phase::kFree:
      plan_free_end();
      break;
    case Phase::kRide:
      plan_ride_end();
      break;
  }
  if (std::isfinite(place_left_)) plan_new_place();
  if (ending_ == Ending::kNever && segment_end_ < kForEver) {
    ending_ = Ending::kSegment;
    end_ = segment_end_;
    duration_s_ = longest_s();
  }
}

void Propagator::plan_stick_end() {
  const bool can_unload = (motion_.one_way_coupling || halt_when_unloaded_) && begun_.c >= 0.0;
  if (!plain_) {
    for (const double side : {1.0, -1.0}) offer_giving_way(stick_gives_way_s(side), side);
    if (can_unload) {
      offer(Ending::kUnloaded, first_rise_s({{}, course_.scaled(-1.0)}, 0.0, longest_s(), Touch::kDoesNot));
    }
    return;
  }
  if (belt_rate_ == 0.0) return;
  const double side = std::copysign(1.0, belt_rate_);
  const double held = side * (begun_.c + share_beside_spring());
  offer_giving_way(paper_.gives_way_s(held, std::abs(belt_rate_), rested_s()), side);
  if (belt_rate_ < 0.0 && can_unload) offer(Ending::kUnloaded, -begun_.c / belt_rate_);
}

void Propagator::plan_slip_end() {
  const bool can_unload = motion_.one_way_coupling || (halt_when_unloaded_ && begun_.c > 0.0);
  if (!plain_) {
    ExponentialPolynomial excess = rate_.scaled(-push_);
    excess += course_rate_.scaled(push_);
    offer(Ending::kCaptured,
          first_rise_s({derivative(slip_, push_), excess}, 0.0, longest_s(), Touch::kCounts));
    if (can_unload) {
      offer(Ending::kUnloaded, first_rise_s({homogeneous(slip_, -1.0), course_.scaled(-1.0)}, 0.0,
                                            longest_s(), Touch::kDoesNot));
    }
    return;
  }
  const PlainSlip slip{begun_, slip_.K, belt_rate_, push_, can_unload};
  if (!(slip == last_slip_.slip)) {
    last_slip_ = {slip, first_rise_s(derivative(slip_, push_), push_ * belt_rate_, Touch::kCounts), {}};
    // The force is gone where −h rises to ±K.
    if (can_unload) last_slip_.unloaded_s = first_rise_s(homogeneous(slip_, -1.0), slip_.K, Touch::kDoesNot);
  }
  offer(Ending::kCaptured, last_slip_.captured_s);
  offer(Ending::kUnloaded, last_slip_.unloaded_s);
}

void Propagator::plan_free_end() {
  if (!plain_) {
    ExponentialPolynomial excess = rate_.scaled(-push_);
    excess += course_rate_.scaled(push_);
    offer(Ending::kMeetsBelt, first_rise_s({{}, excess}, 0.0, longest_s(), Touch::kCounts));
    offer(Ending::kTouchesCoupling, first_rise_s({{}, course_}, 0.0, longest_s(), Touch::kDoesNot));
    return;
  }
  const double acceleration = push_ * omega0_squared_ * mu_k();
  if (acceleration != 0.0) offer(Ending::kMeetsBelt, (belt_rate_ - begun_.rate) / acceleration);
  // c + c′t + at²/2 = 0 from below, by the root that does not cancel.
  const double discriminant = begun_.rate * begun_.rate - 2.0 * acceleration * begun_.c;
  if (discriminant < 0.0) return;
  const double root = std::sqrt(discriminant);
  if (begun_.rate > 0.0) {
    offer(Ending::kTouchesCoupling, -2.0 * begun_.c / (begun_.rate + root));
  } else if (acceleration > 0.0) {
    offer(Ending::kTouchesCoupling, (root - begun_.rate) / acceleration);
  }
}

void Propagator::plan_ride_end() {
  if (plain_) {
    if (belt_rate_ > 0.0) offer(Ending::kTouchesCoupling, -begun_.c / belt_rate_);
    return;
  }
  offer(Ending::kTouchesCoupling, first_rise_s({{}, course_}, 0.0, longest_s(), Touch::kDoesNot));
  const ExponentialPolynomial held = rate_.derivative().scaled(1.0 / omega0_squared_);
  for (const double side : {1.0, -1.0}) offer_giving_way(gives_way_s(held, side, 0.0), side);
}

double Propagator::slid_after(double t_s) const {
  if (rests_on_belt()) return 0.0;
  const double belt = plain_ ? belt_rate_ * t_s : way_.value(t_s);
  return std::abs(belt - (state_at(t_s).c - begun_.c));
}

void Propagator::plan_new_place() {
  if (rests_on_belt()) return;
  // Within a piece the sled slides in one direction, so the distance only grows.
  const double limit_s = ending_ != Ending::kNever ? duration_s_ : longest_s();
  const auto excess = [this](double t_s) { return slid_after(t_s) - place_left_; };
  double high_s = std::fmin(1.0 / std::sqrt(omega0_squared_), limit_s);
  while (excess(high_s) < 0.0 && high_s < limit_s) high_s = std::fmin(2.0 * high_s, limit_s);
  if (excess(high_s) >= 0.0) offer(Ending::kNewPlace, rise_between(excess, 0.0, high_s));
}

}  // namespace stickslip::sim
