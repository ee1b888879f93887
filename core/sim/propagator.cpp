#include "core/sim/propagator.hpp"

#include <cmath>

#include "core/base/contract.hpp"

namespace stickslip::sim {

using friction::Mode;
using friction::SlipWaveform;

Propagator::Propagator(const Motion& motion, double scan_rate_Hz, MotionObserver* observer,
                       std::uint64_t seed)
    : motion_(motion),
      scan_rate_Hz_(scan_rate_Hz),
      observer_(observer),
      omega0_squared_(motion.oscillator.omega0_squared()),
      paper_(motion.paper, {motion.mu_s, motion.mu_k}),
      place_length_(paper_.correlation_length_m() * omega0_squared_ / motion.gravity_m_per_s2) {
  STICKSLIP_EXPECTS(scan_rate_Hz > 0.0);
  STICKSLIP_EXPECTS(omega0_squared_ > 0.0);
  restart(seed);
}

void Propagator::restart(std::uint64_t seed) {
  paper_.restart(seed);
  next_scan_ = 0;
  followed_to_ = {};
  segment_ = 0;
  start_ = {};
  meet_new_place();
  segment_end_ = {};
  belt_rate_ = 0.0;
  halt_when_unloaded_ = false;
  begin(Phase::kStick, {0.0, 0.0}, false, false);  // The first segment follows at once.
}

void Propagator::next(std::span<double> coefficient) {
  for (double& c : coefficient) {
    const ScanTime instant{next_scan_++, 0.0};
    pass_until(instant);
    c = coefficient_at(instant);
  }
}

double Propagator::at(const ScanTime& instant) {
  STICKSLIP_EXPECTS(start_ <= instant);
  pass_until(instant);
  return coefficient_at(instant);
}

void Propagator::follow_to(const ScanTime& instant, ForceFollower& follower) {
  STICKSLIP_EXPECTS(start_ <= followed_to_ && followed_to_ <= instant);
  while (true) {
    const bool ends = ending_ != Ending::kNever && end_ <= instant;
    const ScanTime to = ends ? end_ : instant;
    if (followed_to_ < to) follower.follow(stretch_to(to));
    followed_to_ = to;
    if (!ends) return;
    pass_end();
  }
}

ForceStretch Propagator::stretch_to(const ScanTime& instant) const {
  ForceStretch stretch;
  stretch.duration_s = instant.periods_since(followed_to_) / scan_rate_Hz_;
  if (phase_ == Phase::kFree || phase_ == Phase::kRide) return stretch;  // The coupling is slack.
  const double t_s = followed_to_.periods_since(start_) / scan_rate_Hz_;
  const State state = state_at(t_s);
  stretch.c = state.c;
  stretch.rate_per_s = state.rate;
  stretch.slips = phase_ != Phase::kStick;
  if (stretch.slips)
    stretch.acceleration_per_s2 = (phase_ == Phase::kFaster ? -1.0 : 1.0) * slip_.acceleration(t_s);
  return stretch;
}

double Propagator::coefficient_at(const ScanTime& instant) const {
  const double extension = state_at(instant.periods_since(start_) / scan_rate_Hz_).c;
  return motion_.one_way_coupling ? std::fmax(extension, 0.0) : extension;
}

void Propagator::skip(std::int64_t scans) {
  next_scan_ += scans;
  pass_until({next_scan_, 0.0});
}

void Propagator::pass_until(const ScanTime& instant) {
  while (ending_ != Ending::kNever && end_ <= instant) pass_end();
}

SlipWaveform Propagator::waveform() const {
  const double sign = phase_ == Phase::kFaster ? -1.0 : 1.0;
  return {paper_.now().mu_k, sign * begun_.c - paper_.now().mu_k, sign * begun_.rate, motion_.oscillator};
}

double Propagator::free_acceleration() const {
  return std::copysign(omega0_squared_ * paper_.now().mu_k, belt_rate_ - begun_.rate);
}

Propagator::State Propagator::state_at(double t_s) const {
  switch (phase_) {
    case Phase::kSlower:
      return {slip_.value(t_s), slip_.rate(t_s)};
    case Phase::kFaster:
      return {-slip_.value(t_s), -slip_.rate(t_s)};
    case Phase::kFree: {
      const double acceleration = free_acceleration();
      return {begun_.c + t_s * (begun_.rate + acceleration * t_s / 2.0), begun_.rate + acceleration * t_s};
    }
    case Phase::kStick:
    case Phase::kRide:
      break;
  }
  return {begun_.c + belt_rate_ * t_s, belt_rate_};
}

void Propagator::next_segment() {
  halt_when_unloaded_ = false;
  belt_rate_ = 0.0;
  if (segment_ == motion_.belt.size()) {
    segment_end_ = kForEver;
    return;
  }
  const BeltSegment& segment = motion_.belt[segment_++];
  belt_rate_ = motion_.oscillator.stick_rate_per_s(segment.speed_m_per_s, motion_.gravity_m_per_s2);
  halt_when_unloaded_ = segment.halt_when_unloaded;
  segment_end_ = segment_end_.later(segment.duration_s * scan_rate_Hz_);
}

double Propagator::damper_share() const {
  return motion_.damper_counts_at_onset ? motion_.oscillator.gamma_per_s * belt_rate_ / omega0_squared_ : 0.0;
}

Propagator::Phase Propagator::phase_at_belt_speed(double c) const {
  if (std::abs(c + damper_share()) <= paper_.static_limit(rested_s())) return Phase::kStick;
  // Beyond the static limit the sled cannot follow the belt: it goes where the forces drive it. If
  // they drive it back into the belt's speed from both sides, it stays there.
  const double damping = -motion_.oscillator.gamma_per_s * belt_rate_;
  if (damping - omega0_squared_ * (c - paper_.now().mu_k) < 0.0) return Phase::kSlower;
  if (damping - omega0_squared_ * (c + paper_.now().mu_k) > 0.0) return Phase::kFaster;
  return Phase::kStick;
}

void Propagator::enter(State state, bool capture) {
  if (halt_when_unloaded_ && state.c <= 0.0) {
    halt_when_unloaded_ = false;
    belt_rate_ = 0.0;
  }
  const bool leaving = state.rate < 0.0 || (state.rate == 0.0 && belt_rate_ < 0.0);
  const bool slack = motion_.one_way_coupling && (state.c < 0.0 || (state.c == 0.0 && leaving));
  if (slack) {
    begin(state.rate == belt_rate_ ? Phase::kRide : Phase::kFree, state, false, capture);
  } else if (state.rate == belt_rate_) {
    const Phase phase = phase_at_belt_speed(state.c);
    begin(phase, state, phase != Phase::kStick, capture);  // An onset after no time at all.
  } else {
    begin(state.rate < belt_rate_ ? Phase::kSlower : Phase::kFaster, state, false, capture);
  }
}

void Propagator::begin(Phase phase, State state, bool onset, bool capture) {
  phase_ = phase;
  begun_ = state;
  if (onset) paper_.slipped(rested_s());
  if (phase == Phase::kSlower || phase == Phase::kFaster) slip_ = waveform();
  if (observer_ != nullptr) {
    const Mode mode = phase == Phase::kStick                               ? Mode::kStick
                      : phase == Phase::kSlower || phase == Phase::kFaster ? Mode::kSlip
                                                                           : Mode::kSlack;
    observer_->mode_began({start_, mode, onset, capture, paper_.now(), state.c});
  }
  plan_end();
}

void Propagator::meet_new_place() {
  paper_.renew();
  contact_start_ = start_;
  place_left_ = place_length_;
}

void Propagator::pass_end() {
  const State state = state_at(duration_s_);
  if (std::isfinite(place_left_) && phase_ != Phase::kStick) place_left_ -= slid_after(duration_s_);
  start_ = end_;
  switch (ending_) {
    case Ending::kNever:
      return;
    case Ending::kGivesWay:
      // Exactly at the limit, and exactly at the belt's speed: [13], [14].
      begin(belt_rate_ > 0.0 ? Phase::kSlower : Phase::kFaster,
            {std::copysign(paper_.static_limit(rested_s()), belt_rate_) - damper_share(), belt_rate_}, true,
            false);
      return;
    case Ending::kCaptured:
      meet_new_place();
      enter({state.c, belt_rate_}, true);
      return;
    case Ending::kMeetsBelt:
      meet_new_place();
      enter({std::fmin(state.c, 0.0), belt_rate_}, false);
      return;
    case Ending::kUnloaded:
      enter({0.0, std::fmin(state.rate, 0.0)}, false);
      return;
    case Ending::kTouchesCoupling:
      enter({0.0, std::fmax(state.rate, 0.0)}, false);
      return;
    case Ending::kNewPlace:
      meet_new_place();
      enter(state, false);
      return;
    case Ending::kSegment:
      next_segment();
      enter(state, false);
      return;
  }
}

}  // namespace stickslip::sim
