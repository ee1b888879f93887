#include "core/accuracy/reference.hpp"

#include "core/base/contract.hpp"

namespace stickslip::accuracy {

using sim::Motion;

std::string_view lacks_reference(const Motion& motion) noexcept {
  if (motion.rate_and_state) return "rate-and-state friction has no closed form";
  if (motion.velocity_dependence) return "friction that depends on speed has no closed form";
  if (motion.kinetic_drift) return "K drifts";
  if (motion.paper.scatter || motion.paper.first_peak || motion.paper.contact_ageing) {
    return "S and K differ from contact to contact";
  }
  for (const sim::BeltSegment& segment : motion.belt) {
    if (segment.acceleration_m_per_s2 != 0.0 || segment.jerk_m_per_s3 != 0.0 ||
        segment.decaying_speed_m_per_s != 0.0) {
      return "the belt's speed changes gradually";
    }
  }
  return {};
}

Reference::Reference(const Motion& motion, double scan_rate_Hz)
    : motion_(motion),
      scan_period_s_(1 / Real(scan_rate_Hz)),
      gamma_(motion.oscillator.gamma_per_s),
      omega_squared_(motion.oscillator.omega_squared),
      omega0_squared_(omega_squared_ + gamma_ * gamma_ / 4),
      S_(motion.mu_s),
      K_(motion.mu_k) {
  STICKSLIP_EXPECTS(scan_rate_Hz > 0.0);
  STICKSLIP_EXPECTS(lacks_reference(motion).empty());
  segment_end_s_ = Real(0);
  const Real per_metre = omega0_squared_ / Real(motion.gravity_m_per_s2);
  const bool rides = motion.startup_slack_m > 0.0 && !motion.belt.empty();
  if (rides) belt_rate_ = per_metre * Real(motion.belt.front().speed_m_per_s);
  begin(rides ? Phase::kRides : Phase::kStick, {-Real(motion.startup_slack_m) * per_metre, belt_rate_});
}

void Reference::next(std::span<double> coefficient) {
  for (double& c : coefficient) {
    c = static_cast<double>(now());
    ++next_scan_;
  }
}

Real Reference::now() {
  const Real instant_s = Real(next_scan_) * scan_period_s_;
  go_to(instant_s);
  const Real c = state_at(instant_s - start_s_).c;
  return motion_.one_way_coupling && c < 0 ? Real(0) : c;
}

void Reference::skip(std::int64_t scans) {
  next_scan_ += scans;
  go_to(Real(next_scan_) * scan_period_s_);
}

Reference::State Reference::state_at(const Real& t_s) const {
  switch (phase_) {
    case Phase::kSlower:
    case Phase::kFaster:
      return {slip_.value(t_s), slip_.rate(t_s)};
    case Phase::kFlies: {
      const Real acceleration = friction();
      return {begun_.c + begun_.rate * t_s + acceleration * t_s * t_s / 2, begun_.rate + acceleration * t_s};
    }
    case Phase::kStick:
    case Phase::kRides:
      break;
  }
  return {begun_.c + belt_rate_ * t_s, belt_rate_};
}

/// Of the sled as c″ by friction alone, while it slides.
Real Reference::friction() const {
  return begun_.rate > belt_rate_ ? Real(-omega0_squared_ * K_) : Real(omega0_squared_ * K_);
}

Real Reference::damper_share() const {
  return motion_.damper_counts_at_onset ? Real(gamma_ * belt_rate_ / omega0_squared_) : Real(0);
}

void Reference::go_to(const Real& instant_s) {
  for (;;) {
    const bool segment_first =
        segment_end_s_ && (event_ == Event::kNone || *segment_end_s_ < start_s_ + event_s_);
    if (segment_first) {
      if (*segment_end_s_ > instant_s) return;
      const State state = state_at(*segment_end_s_ - start_s_);
      start_s_ = *segment_end_s_;
      next_segment();
      settle(state);
    } else {
      if (event_ == Event::kNone || start_s_ + event_s_ > instant_s) return;
      happens();
    }
  }
}

void Reference::next_segment() {
  halts_ = false;
  belt_rate_ = 0;
  if (segment_ == motion_.belt.size()) {
    segment_end_s_.reset();
    return;
  }
  const sim::BeltSegment& segment = motion_.belt[segment_++];
  belt_rate_ = omega0_squared_ * Real(segment.speed_m_per_s) / Real(motion_.gravity_m_per_s2);
  halts_ = segment.halt_when_unloaded;
  *segment_end_s_ += Real(segment.duration_s);
}

void Reference::happens() {
  State state = state_at(event_s_);
  start_s_ += event_s_;
  switch (event_) {
    case Event::kNone:
      return;
    case Event::kOnset:
      last_onset_s_ = start_s_;
      state = {belt_rate_ > 0 ? Real(S_ - damper_share()) : Real(-S_ - damper_share()), belt_rate_};
      begin(belt_rate_ > 0 ? Phase::kSlower : Phase::kFaster, state);
      return;
    case Event::kCapture:
      ++capture_count_;
      last_capture_s_ = start_s_;
      settle({state.c, belt_rate_});
      return;
    case Event::kMeetsBelt:
      settle({state.c, belt_rate_});
      return;
    case Event::kUnloads:
    case Event::kLoads:
      settle({Real(0), state.rate});
      return;
  }
}

/// Coulomb's law for any state.
void Reference::settle(const State& state) {
  if (halts_ && state.c <= 0) {
    halts_ = false;
    belt_rate_ = 0;
  }
  if (motion_.one_way_coupling) {
    const bool leaves = state.rate < 0 || (state.rate == 0 && belt_rate_ < 0);
    if (state.c < 0 || (state.c == 0 && leaves)) {
      begin(state.rate == belt_rate_ ? Phase::kRides : Phase::kFlies, state);
      return;
    }
  }
  if (state.rate < belt_rate_) return begin(Phase::kSlower, state);
  if (state.rate > belt_rate_) return begin(Phase::kFaster, state);
  const Real held = state.c + damper_share();
  if (abs(held) <= S_) return begin(Phase::kStick, state);
  // Sliding friction at its most cannot hold the sled: it goes where the force drives it.
  const Real pull = -omega0_squared_ * state.c - gamma_ * belt_rate_;
  if (pull + omega0_squared_ * K_ < 0) return begin(Phase::kSlower, state);
  if (pull - omega0_squared_ * K_ > 0) return begin(Phase::kFaster, state);
  begin(Phase::kStick, state);
}

void Reference::begin(Phase phase, const State& state) {
  phase_ = phase;
  begun_ = state;
  if (phase == Phase::kSlower || phase == Phase::kFaster) {
    const Real rest = phase == Phase::kSlower ? K_ : Real(-K_);
    slip_ = {rest, state.c - rest, state.rate, gamma_, omega_squared_};
  }
  plan();
}

void Reference::offer(Event event, const std::optional<Real>& t_s) {
  if (!t_s || (event_ != Event::kNone && *t_s >= event_s_)) return;
  event_ = event;
  event_s_ = *t_s;
}

void Reference::plan() {
  event_ = Event::kNone;
  switch (phase_) {
    case Phase::kStick:
      if (belt_rate_ > 0) offer(Event::kOnset, Real((S_ - damper_share() - begun_.c) / belt_rate_));
      if (belt_rate_ < 0) {
        offer(Event::kOnset, Real((-S_ - damper_share() - begun_.c) / belt_rate_));
        if ((motion_.one_way_coupling || halts_) && begun_.c >= 0)
          offer(Event::kUnloads, Real(-begun_.c / belt_rate_));
      }
      return;
    case Phase::kSlower:
    case Phase::kFaster:
      plan_slip();
      return;
    case Phase::kFlies:
      plan_flight();
      return;
    case Phase::kRides:
      if (belt_rate_ > 0) offer(Event::kLoads, Real(-begun_.c / belt_rate_));
      return;
  }
}

void Reference::plan_slip() {
  const bool known =
      solved_ && solved_->c == begun_.c && solved_->rate == begun_.rate && solved_->belt_rate == belt_rate_;
  if (!known) {
    solved_ = Solved{begun_.c, begun_.rate, belt_rate_,
                     phase_ == Phase::kSlower ? slip_.first_rise_of_rate(belt_rate_)
                                              : slip_.first_fall_of_rate(belt_rate_)};
  }
  offer(Event::kCapture, solved_->capture_s);
  const bool unloads = motion_.one_way_coupling || (halts_ && begun_.c > 0);
  if (unloads) offer(Event::kUnloads, slip_.first_fall(Real(0)));
}

void Reference::plan_flight() {
  const Real acceleration = friction();
  if (acceleration == 0 && begun_.rate <= 0) return;
  if (acceleration != 0) offer(Event::kMeetsBelt, Real((belt_rate_ - begun_.rate) / acceleration));
  // c + c′t + at²/2 = 0 at its least t > 0.
  if (acceleration == 0) return offer(Event::kLoads, Real(-begun_.c / begun_.rate));
  const Real discriminant = begun_.rate * begun_.rate - 2 * acceleration * begun_.c;
  if (discriminant < 0) return;
  const Real root = sqrt(discriminant);
  const Real t1 = (-begun_.rate - root) / acceleration;
  const Real t2 = (-begun_.rate + root) / acceleration;
  const Real least = t1 < t2 ? t1 : t2;
  const Real most = t1 < t2 ? t2 : t1;
  if (least > 0) {
    offer(Event::kLoads, least);
  } else if (most > 0) {
    offer(Event::kLoads, most);
  }
}

}  // namespace stickslip::accuracy
