// How each piece of the motion ends: the earliest of the events that its phase can meet.
#include <algorithm>
#include <cmath>

#include "core/sim/bracket.hpp"
#include "core/sim/first_rise.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::sim {

using friction::SlipWaveform;

namespace {

/// Without the offset K: what is left is a solution of the homogeneous equation.
SlipWaveform homogeneous(const SlipWaveform& slip, double sign) {
  return {0.0, sign * slip.D, sign * slip.r, slip.oscillator};
}

/// c′ as a function of its own: from c′(0) with the slope c″(0).
SlipWaveform derivative(const SlipWaveform& slip) {
  const double slope = -slip.oscillator.gamma_per_s * slip.r - slip.oscillator.omega0_squared() * slip.D;
  return {0.0, slip.r, slope, slip.oscillator};
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

void Propagator::plan_end() {
  ending_ = Ending::kNever;
  switch (phase_) {
    case Phase::kStick:
      if (belt_rate_ != 0.0) {
        const double held = std::copysign(1.0, belt_rate_) * (begun_.c + damper_share());
        offer(Ending::kGivesWay, paper_.gives_way_s(held, std::abs(belt_rate_), rested_s()));
      }
      if (belt_rate_ < 0.0) {
        const bool can_unload = (motion_.one_way_coupling || halt_when_unloaded_) && begun_.c >= 0.0;
        if (can_unload) offer(Ending::kUnloaded, -begun_.c / belt_rate_);
      }
      break;
    case Phase::kSlower:
    case Phase::kFaster:
      plan_slip_end();
      break;
    case Phase::kFree:
      plan_free_end();
      break;
    case Phase::kRide:
      if (belt_rate_ > 0.0) offer(Ending::kTouchesCoupling, -begun_.c / belt_rate_);
      break;
  }
  if (std::isfinite(place_left_)) plan_new_place();
  if (ending_ == Ending::kNever && segment_end_ < kForEver) {
    ending_ = Ending::kSegment;
    end_ = segment_end_;
    duration_s_ = segment_end_.periods_since(start_) / scan_rate_Hz_;
  }
}

void Propagator::plan_slip_end() {
  const bool faster = phase_ == Phase::kFaster;
  const double level = faster ? -belt_rate_ : belt_rate_;
  offer(Ending::kCaptured, first_rise_s(derivative(slip_), level, Touch::kCounts));
  if (!motion_.one_way_coupling && !(halt_when_unloaded_ && begun_.c > 0.0)) return;
  // Slower: K − c rises to K where the force is gone; faster, mirrored: −c − K rises to −K.
  const SlipWaveform unloading = homogeneous(slip_, faster ? 1.0 : -1.0);
  offer(Ending::kUnloaded,
        first_rise_s(unloading, faster ? -paper_.now().mu_k : paper_.now().mu_k, Touch::kDoesNot));
}

void Propagator::plan_free_end() {
  const double acceleration = free_acceleration();
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

double Propagator::slid_after(double t_s) const {
  switch (phase_) {
    case Phase::kSlower:
    case Phase::kFaster:
    case Phase::kFree:
      return std::abs(belt_rate_ * t_s - (state_at(t_s).c - begun_.c));
    case Phase::kStick:
    case Phase::kRide:
      break;
  }
  return 0.0;
}

void Propagator::plan_new_place() {
  if (phase_ == Phase::kStick || phase_ == Phase::kRide) return;
  // Within a piece the sled slides in one direction, so the distance only grows.
  const double longest_s =
      ending_ != Ending::kNever ? duration_s_ : segment_end_.periods_since(start_) / scan_rate_Hz_;
  const auto excess = [this](double t_s) { return slid_after(t_s) - place_left_; };
  double high_s = std::fmin(1.0 / std::sqrt(omega0_squared_), longest_s);
  while (excess(high_s) < 0.0 && high_s < longest_s) high_s = std::fmin(2.0 * high_s, longest_s);
  if (excess(high_s) >= 0.0) offer(Ending::kNewPlace, rise_between(excess, 0.0, high_s));
}

}  // namespace stickslip::sim
