#include "core/sim/propagator.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "core/sim/motion_contract.hpp"

namespace stickslip::sim {

using model::DampedBasis;
using model::Mode;

namespace {

/// Scans between two evaluations of a slip's closed form. In between, a constant matrix advances the
/// oscillation by one scan; each step adds an error of about one rounding of the amplitude.
constexpr std::int64_t kStride = 16;

/// Distance from the static limit, relative to max(1, limit), within which the force at a slip onset is set
/// exactly to the limit. A larger difference is real: the share that the damper held.
constexpr double kAtTheLimit = 1e-9;

}  // namespace

Propagator::Propagator(const Motion& motion, double scan_rate_Hz, MotionObserver* observer,
                       std::uint64_t seed)
    : motion_(motion),
      scan_rate_Hz_(scan_rate_Hz),
      observer_(observer),
      omega0_squared_(motion.oscillator.omega0_squared()),
      turn_{},
      paper_(motion.paper, {motion.mu_s, motion.mu_k}),
      place_length_(paper_.correlation_length_m() * omega0_squared_ / motion.gravity_m_per_s2) {
  STICKSLIP_EXPECTS(scan_rate_Hz > 0.0);
  expect_sound(motion);
  STICKSLIP_EXPECTS(has_closed_form(motion));
  const double half_gamma = motion.oscillator.gamma_per_s / 2.0;
  const DampedBasis at = model::damped_basis(motion.oscillator, 1.0 / scan_rate_Hz);
  turn_ = {at.cosine + half_gamma * at.sine, at.sine, -omega0_squared_ * at.sine,
           at.cosine - half_gamma * at.sine};
  restart(seed);
}

void Propagator::restart(std::uint64_t seed) {
  paper_.restart(seed);
  next_scan_ = 0;
  followed_to_ = {};
  start_ = {};
  meet_new_place();
  segment_ = 0;
  segment_start_ = {};
  segment_end_ = {};
  segment_rate_ = {};
  segment_travel_ = 0.0;
  halt_when_unloaded_ = false;
  plain_ = true;
  belt_rate_ = 0.0;
  belt_slope_ = 0.0;
  drift_factor_ = 1.0;
  // The first segment follows at once.
  if (motion_.startup_slack_m > 0.0) {
    const double slack = omega0_squared_ * motion_.startup_slack_m / motion_.gravity_m_per_s2;
    begin(Phase::kRide, {-slack, 0.0}, false, false);
  } else {
    begin(Phase::kStick, {0.0, 0.0}, false, false);
  }
}

void Propagator::next(std::span<double> coefficient) {
  while (!coefficient.empty()) {
    pass_until({next_scan_, 0.0});
    std::size_t count = coefficient.size();
    if (ending_ != Ending::kNever) {
      const std::int64_t left = end_.scan - next_scan_ + (end_.fraction > 0.0 ? 1 : 0);
      count = static_cast<std::size_t>(std::min(static_cast<std::int64_t>(count), left));
    }
    fill(coefficient.first(count));
    coefficient = coefficient.subspan(count);
  }
}

/// All in the present piece.
void Propagator::fill(std::span<double> coefficient) {
  if (plain_ && slips()) {
    for (double& c : coefficient) {
      stride_to(next_scan_++);
      c = as_read(slip_.K + stride_.wave.h);
    }
  } else if (plain_ && rests_on_belt()) {
    for (double& c : coefficient) {
      c = as_read(begun_.c + belt_rate_ * seconds_since_start({next_scan_++, 0.0}));
    }
  } else {
    for (double& c : coefficient) c = coefficient_at({next_scan_++, 0.0});
  }
}

double Propagator::at(const ScanTime& instant) {
  STICKSLIP_EXPECTS(start_ <= instant);
  pass_until(instant);
  return coefficient_at(instant);
}

/// Anchors are counted from the start of the piece, so that the result does not depend on earlier calls.
void Propagator::stride_to(std::int64_t scan) {
  const std::int64_t first = start_.scan + (start_.fraction > 0.0 ? 1 : 0);
  const std::int64_t anchor = first + (scan - first) / kStride * kStride;
  if (stride_.scan < anchor || stride_.scan > scan) {
    stride_ = {anchor, wave_at(seconds_since_start({anchor, 0.0}))};
  }
  for (; stride_.scan < scan; ++stride_.scan) {
    const Wave wave = stride_.wave;
    stride_.wave = {turn_.h_from_h * wave.h + turn_.h_from_rate * wave.rate,
                    turn_.rate_from_h * wave.h + turn_.rate_from_rate * wave.rate};
  }
}

double Propagator::coefficient_at(const ScanTime& instant) {
  const double t_s = seconds_since_start(instant);
  if (!slips() || instant.fraction != 0.0) return as_read(state_at(t_s).c);
  stride_to(instant.scan);
  return as_read((plain_ ? slip_.K : course_.value(t_s)) + stride_.wave.h);
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
  const double t_s = seconds_since_start(followed_to_);
  if (!plain_) {
    stretch.course = course_.later(t_s);
  } else if (phase_ == Phase::kStick) {
    stretch.course = ExponentialPolynomial{begun_.c + belt_rate_ * t_s};
    stretch.course.add_power(1, belt_rate_);
  } else {
    stretch.course = ExponentialPolynomial{slip_.K};
  }
  if (slips()) {
    const Wave wave = wave_at(t_s);
    stretch.wave = wave.h;
    stretch.wave_rate_per_s = wave.rate;
  }
  return stretch;
}

void Propagator::skip(std::int64_t scans) {
  next_scan_ += scans;
  pass_until({next_scan_, 0.0});
}

void Propagator::pass_until(const ScanTime& instant) {
  while (ending_ != Ending::kNever && end_ <= instant) pass_end();
}

Propagator::Wave Propagator::wave_at(double t_s) const {
  const DampedBasis at = model::damped_basis(slip_.oscillator, t_s);
  const double half_gamma = slip_.oscillator.gamma_per_s / 2.0;
  return {slip_.D * at.cosine + (slip_.r + half_gamma * slip_.D) * at.sine,
          slip_.r * at.cosine - (half_gamma * slip_.r + omega0_squared_ * slip_.D) * at.sine};
}

Propagator::State Propagator::state_at(double t_s) const {
  State state{0.0, 0.0};
  if (!plain_) {
    state = {course_.value(t_s), course_rate_.value(t_s)};
  } else if (slips()) {
    state.c = slip_.K;
  } else if (phase_ == Phase::kFree) {
    const double acceleration = push_ * omega0_squared_ * mu_k();
    return {begun_.c + t_s * (begun_.rate + acceleration * t_s / 2.0), begun_.rate + acceleration * t_s};
  } else {
    return {begun_.c + belt_rate_ * t_s, belt_rate_};
  }
  if (slips()) {
    const Wave wave = wave_at(t_s);
    state.c += wave.h;
    state.rate += wave.rate;
  }
  return state;
}

double Propagator::share_beside_spring() const {
  const double damper = motion_.damper_counts_at_onset ? motion_.oscillator.gamma_per_s * belt_rate_ : 0.0;
  return (belt_slope_ + damper) / omega0_squared_;
}

Propagator::Phase Propagator::phase_at_belt_speed(double c) const {
  if (std::abs(c + share_beside_spring()) <= static_limit()) return Phase::kStick;
  // Beyond the static limit the sled cannot follow the belt: it goes where the forces drive it. If
  // they drive it back into the belt's speed from both sides, it stays there.
  const double drag = -motion_.oscillator.gamma_per_s * belt_rate_ - belt_slope_;
  if (drag - omega0_squared_ * (c - mu_k()) < 0.0) return Phase::kSlower;
  if (drag - omega0_squared_ * (c + mu_k()) > 0.0) return Phase::kFaster;
  return Phase::kStick;
}

void Propagator::enter(State state, bool capture) {
  if (halt_when_unloaded_ && state.c <= 0.0) halt_belt();
  const bool leaving = state.rate < 0.0 || (state.rate == 0.0 && leaves_backwards());
  const bool slack = motion_.one_way_coupling && (state.c < 0.0 || (state.c == 0.0 && leaving));
  if (slack) {
    // Without a spring the belt's acceleration is all that friction has to give the sled.
    const bool rides = state.rate == belt_rate_ && std::abs(belt_slope_) <= omega0_squared_ * static_limit();
    begin(rides ? Phase::kRide : Phase::kFree, state, false, capture);
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
  set_out();
  if (observer_ != nullptr) {
    const Mode mode = phase == Phase::kStick ? Mode::kStick : (slips() ? Mode::kSlip : Mode::kSlack);
    const double drift = mu_k() - paper_.now().mu_k;
    observer_->mode_began({start_, mode, onset, capture, {paper_.now().mu_s + drift, mu_k()}, state.c});
  }
  plan_end();
}

void Propagator::set_out() {
  stride_.scan = -1;
  const auto relative = begun_.rate == belt_rate_ ? belt_slope_ : belt_rate_ - begun_.rate;
  push_ = phase_ == Phase::kSlower ? 1.0 : phase_ == Phase::kFaster ? -1.0 : std::copysign(1.0, relative);
  if (plain_) {
    if (slips()) {
      const double level = push_ * mu_k();
      slip_ = {level, begun_.c - level, begun_.rate, motion_.oscillator};
    }
    return;
  }
  slip_ = {0.0, 0.0, 0.0, motion_.oscillator};
  if (rests_on_belt()) {
    course_ = way_;
    course_.add_power(0, begun_.c);
    course_rate_ = rate_;
    return;
  }
  const ExponentialPolynomial friction = factor_.scaled(push_ * paper_.now().mu_k);
  if (phase_ == Phase::kFree) {
    course_rate_ = friction.scaled(omega0_squared_).integral();
    course_rate_.add_power(0, begun_.rate);
    course_ = course_rate_.integral();
    course_.add_power(0, begun_.c);
    return;
  }
  course_ = friction.response(motion_.oscillator);
  course_rate_ = course_.derivative();
  slip_.D = begun_.c - course_.value(0.0);
  slip_.r = begun_.rate - course_rate_.value(0.0);
}

void Propagator::meet_new_place() {
  paper_.renew();
  contact_start_ = start_;
  place_left_ = place_length_;
}

void Propagator::pass_end() {
  State state = state_at(duration_s_);
  if (std::isfinite(place_left_) && phase_ != Phase::kStick) place_left_ -= slid_after(duration_s_);
  start_ = end_;
  if (ending_ == Ending::kSegment) {
    const bool first = segment_ == 0;
    next_segment();
    // A sled that is slack from the start has been riding on the belt.
    if (rests_on_belt() && (joins_smoothly_ || (first && phase_ == Phase::kRide))) state.rate = belt_rate_;
  } else if (!plain_) {
    look_ahead();
    if (rests_on_belt()) state.rate = belt_rate_;
  }
  switch (ending_) {
    case Ending::kNever:
      return;
    case Ending::kGivesWay:
      give_way(state);
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
      enter(state, false);
      return;
  }
}

void Propagator::give_way(State state) {
  if (phase_ == Phase::kRide) {
    begin(Phase::kFree, state, false, false);
    return;
  }
  // Exactly at the limit, and exactly at the belt's speed: [13], [14].
  const double at_limit = gives_way_to_ * static_limit() - share_beside_spring();
  if (std::abs(state.c - at_limit) <= kAtTheLimit * std::fmax(1.0, static_limit())) state.c = at_limit;
  begin(gives_way_to_ > 0.0 ? Phase::kSlower : Phase::kFaster, {state.c, belt_rate_}, true, false);
}

}  // namespace stickslip::sim
