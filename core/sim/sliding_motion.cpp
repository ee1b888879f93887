#include "core/sim/sliding_motion.hpp"

#include <cmath>

#include "core/base/contract.hpp"
#include "core/sim/bounded_rise.hpp"

namespace stickslip::sim {

using model::Mode;

namespace {

/// Largest error of the coefficient, divided by tolerance and number of cycles (measured).
constexpr double kSlidingGrowth = 200.0;
/// Smallest tolerance for a coefficient of order one; below it CVODE's error estimates are rounding errors.
constexpr double kLeastSlidingTolerance = 16.0 * std::numeric_limits<double>::epsilon();
/// Rates of the belt before and after a change that differ by less are the same: they came by sums.
constexpr double kSameRate = 64.0 * std::numeric_limits<double>::epsilon();

}  // namespace

SlidingMotion::SlidingMotion(const Motion& motion, double scan_rate_Hz, double accuracy,
                             MotionObserver* observer)
    : motion_(motion),
      scan_rate_Hz_(scan_rate_Hz),
      observer_(observer),
      omega0_squared_(motion.oscillator.omega0_squared()),
      choice_(ToleranceChoice::of(motion, accuracy, kSlidingGrowth,
                                  kLeastSlidingTolerance * std::fmax(motion.mu_s, 1.0))),
      stiff_(!motion.oscillator.oscillates()),
      paper_(motion.paper, {motion.mu_s, motion.mu_k}),
      place_length_(paper_.correlation_length_m() * omega0_squared_ / motion.gravity_m_per_s2),
      walk_(motion_, scan_rate_Hz),
      system_(motion.oscillator, motion.gravity_m_per_s2, motion.velocity_dependence),
      cvode_(stiff_ ? Cvode::Method::kBdf : Cvode::Method::kAdams, system_, 2,
             0.1 / std::sqrt(omega0_squared_)) {
  system_.set_doubt(choice_.accuracy * std::sqrt(omega0_squared_));
  cvode_.set_tolerance({choice_.tolerance, choice_.tolerance, 1.0});
  // Extremes of c′ and of c are π/ω apart: no two of them are in one step.
  cvode_.set_longest_step(1.0 / std::sqrt(omega0_squared_));
  if (const auto& law = motion.velocity_dependence) {
    STICKSLIP_EXPECTS(0.0 <= law->stribeck_rise && law->stribeck_rise <= motion.mu_s - motion.mu_k);
    STICKSLIP_EXPECTS(law->stribeck_speed_m_per_s > 0.0 && law->stribeck_exponent > 0.0);
  }
}

SolverMethod SlidingMotion::method() const {
  return {stiff_ ? "SUNDIALS CVODE (BDF)" : "SUNDIALS CVODE (Adams)", choice_.accuracy * cvode_.widened(),
          cvode_.undecided_count() - undecided_before_};
}

void SlidingMotion::restart(std::uint64_t seed) {
  undecided_before_ = cvode_.undecided_count();
  paper_.restart(seed);
  walk_.restart();
  start_ = {};
  meet_new_place();
  look_at_belt();
  const double slack = motion_.startup_slack_m * omega0_squared_ / motion_.gravity_m_per_s2;
  begin(slack > 0.0 ? Phase::kRide : Phase::kStick, {-slack, 0.0}, false,
        false);  // The first segment follows.
}

void SlidingMotion::look_at_belt() {
  belt_ = walk_.from(start_);
  drift_ = {};
  if (!motion_.kinetic_drift) return;
  drift_.drift = motion_.kinetic_drift;
  drift_.belt = belt_;
  const double scale = motion_.kinetic_drift->scale;
  if (motion_.kinetic_drift->over == KineticDrift::Over::kTime) {
    drift_.x = start_.periods_since({}) / scan_rate_Hz_ / scale;
    drift_.x_per_s = 1.0 / scale;
  } else {
    drift_.x_per_c = motion_.gravity_m_per_s2 / omega0_squared_ / scale;
    drift_.x = walk_.travel(start_) * drift_.x_per_c;
  }
}

SlidingMotion::State SlidingMotion::state_at(double t_s) const {
  if (!slides(phase_)) return {begun_.c + belt_.travel(t_s), belt_.at(t_s)};
  if (t_s == 0.0) return begun_;
  const OdeState y = cvode_.state_at(t_s);
  return {y[0], y[1] * std::sqrt(omega0_squared_)};
}

SpringForce SlidingMotion::force_at(const ScanTime& instant) const {
  STICKSLIP_EXPECTS(known_from_ <= instant && instant <= known_to_);
  if (slack(phase_)) return {};
  const double t_s = instant == known_to_ ? solved_s_ : instant.periods_since(start_) / scan_rate_Hz_;
  const State state = state_at(t_s);
  const bool cut = motion_.one_way_coupling && phase_ != Phase::kStick;
  return {cut ? std::fmax(state.c, 0.0) : state.c, state.rate};
}

/// At most S − K of the contact at hand, which may differ from the scene's.
double SlidingMotion::stribeck_rise() const {
  if (!motion_.velocity_dependence) return 0.0;
  return std::fmin(motion_.velocity_dependence->stribeck_rise, paper_.now().mu_s - paper_.now().mu_k);
}

Coefficients SlidingMotion::limits(double t_s) const {
  const double more = (drift_.factor(t_s) - 1.0) * paper_.now().mu_k;
  return {paper_.static_limit(rested_s() + t_s) + more, paper_.now().mu_k + more + stribeck_rise()};
}

Coefficients SlidingMotion::observed_paper() const {
  const double more = (drift_.factor(0.0) - 1.0) * paper_.now().mu_k;
  return {paper_.now().mu_s + more, paper_.now().mu_k + more};
}

/// What the belt's acceleration, and the damper if it counts, add to the spring.
double SlidingMotion::onset_share(double t_s) const {
  const double damper = motion_.damper_counts_at_onset ? motion_.oscillator.gamma_per_s * belt_.at(t_s) : 0.0;
  return (damper + belt_.slope_at(t_s)) / omega0_squared_;
}

SlidingMotion::Phase SlidingMotion::phase_at_belt_speed(double c) const {
  const Coefficients now = limits(0.0);
  if (std::abs(c + onset_share(0.0)) <= now.mu_s) return Phase::kStick;
  // Beyond the static limit the sled cannot follow the belt: it goes where the forces drive it. If
  // they drive it back into the belt's speed from both sides, it stays there.
  const double others = motion_.oscillator.gamma_per_s * belt_.at(0.0) + belt_.slope_at(0.0);
  if (others + omega0_squared_ * (c - now.mu_k) > 0.0) return Phase::kSlower;
  if (others + omega0_squared_ * (c + now.mu_k) < 0.0) return Phase::kFaster;
  return Phase::kStick;
}

void SlidingMotion::enter(State state, bool capture) {
  if (walk_.halts_when_unloaded() && state.c <= 0.0) {
    walk_.halt(start_);
    look_at_belt();
  }
  const double rate = belt_.at(0.0);
  const double slope = belt_.slope_at(0.0);
  if (std::abs(state.rate - rate) <= kSameRate * std::fmax(std::abs(rate), std::abs(state.rate))) {
    state.rate = rate;
  }
  const bool belt_leaves = rate < 0.0 || (rate == 0.0 && slope < 0.0);
  const bool leaving = state.rate < 0.0 || (state.rate == 0.0 && belt_leaves);
  const bool loose = motion_.one_way_coupling && (state.c < 0.0 || (state.c == 0.0 && leaving));
  if (loose) {
    // Nothing but friction moves the sled: it follows the belt as far as that goes.
    const bool rides = state.rate == rate && std::abs(slope) <= omega0_squared_ * limits(0.0).mu_s;
    begin(rides ? Phase::kRide : Phase::kFree, state, false, capture);
  } else if (state.rate == rate) {
    const Phase phase = phase_at_belt_speed(state.c);
    begin(phase, state, phase != Phase::kStick, capture);  // An onset after no time at all.
  } else {
    begin(state.rate < rate ? Phase::kSlower : Phase::kFaster, state, false, capture);
  }
}

void SlidingMotion::begin(Phase phase, State state, bool onset, bool capture) {
  phase_ = phase;
  begun_ = state;
  if (onset) paper_.slipped(rested_s());
  if (observer_ != nullptr) {
    const Mode mode = phase == Phase::kStick ? Mode::kStick : slack(phase) ? Mode::kSlack : Mode::kSlip;
    observer_->mode_began({start_, mode, onset, capture, observed_paper(), state.c});
  }
  if (slides(phase)) {
    begin_sliding();
  } else {
    plan_rest();
  }
}

void SlidingMotion::end_at(Ending ending, double t_s) {
  ending_ = ending;
  solved_s_ = t_s;
  known_to_ = ending == Ending::kSegment ? walk_.segment_end() : time(t_s);
}

void SlidingMotion::meet_new_place() {
  paper_.renew();
  contact_start_ = start_;
  place_left_ = place_length_;
}

void SlidingMotion::begin_sliding() {
  known_from_ = start_;
  known_to_ = start_;
  solved_s_ = 0.0;
  ending_ = Ending::kOngoing;
  const bool taut = phase_ != Phase::kFree;
  const double rate = belt_.at(0.0);
  SlidingSystem::Piece piece;
  piece.taut = taut;
  piece.sign = phase_ == Phase::kSlower ? 1.0 : -1.0;
  if (!taut) {
    const bool slower = begun_.rate < rate || (begun_.rate == rate && belt_.slope_at(0.0) > 0.0);
    piece.sign = slower ? 1.0 : -1.0;
  }
  piece.watches_force = motion_.one_way_coupling || (walk_.halts_when_unloaded() && begun_.c > 0.0);
  piece.begun_c = begun_.c;
  piece.mu_k = paper_.now().mu_k;
  piece.stribeck_rise = stribeck_rise();
  piece.place_left = place_left_;
  piece.belt = belt_;
  piece.drift = drift_;
  system_.begin(piece);
  if (walk_.left_s(start_) > 0.0) {
    cvode_.restart({begun_.c, begun_.rate / std::sqrt(omega0_squared_), 0.0});
  } else {
    end_at(Ending::kSegment, 0.0);
  }
}

void SlidingMotion::slide_on() {
  const Cvode::Step step = cvode_.step();
  const double left_s = walk_.left_s(start_);
  known_from_ = known_to_;
  if (step.t_s >= left_s) {
    end_at(Ending::kSegment, left_s);
  } else if (!step.event) {
    end_at(step.t_s < kLongestPiece_s ? Ending::kOngoing : Ending::kFreshStart, step.t_s);
  } else if (*step.event == SlidingSystem::kBeltSpeed) {
    end_at(Ending::kBeltSpeed, step.t_s);
  } else if (*step.event == SlidingSystem::kNoForce) {
    end_at(phase_ == Phase::kFree ? Ending::kTouchesCoupling : Ending::kUnloaded, step.t_s);
  } else {
    end_at(Ending::kNewPlace, step.t_s);
  }
}

void SlidingMotion::advance() {
  if (ending_ == Ending::kOngoing) {
    slide_on();
  } else {
    pass_end();
  }
}

void SlidingMotion::pass_end() {
  const State state = state_at(solved_s_);
  if (std::isfinite(place_left_) && slides(phase_)) place_left_ -= system_.slid(solved_s_, state.c);
  const Ending ending = ending_;
  const double share = onset_share(solved_s_);
  const Coefficients limit = limits(solved_s_);
  // A sled that is slack from the start has been riding on the belt, at the speed of the first segment.
  const bool rides_from_start = phase_ == Phase::kRide && walk_.before_first();
  start_ = known_to_;
  if (ending == Ending::kSegment) walk_.next_segment();
  look_at_belt();
  switch (ending) {
    case Ending::kOngoing:
      return;
    case Ending::kGivesWay: {
      if (phase_ == Phase::kRide) {
        begin(Phase::kFree, state, false, false);
        return;
      }
      // Exactly at the limit, and exactly at the belt's speed: [13], [14].
      const double sign = std::copysign(1.0, state.c + share);
      const bool at_limit = std::abs(sign * (state.c + share) - limit.mu_s) <= 1e-9 * limit.mu_s;
      const double c = at_limit ? sign * limit.mu_s - share : state.c;
      begin(sign > 0.0 ? Phase::kSlower : Phase::kFaster, {c, belt_.at(0.0)}, true, false);
      return;
    }
    case Ending::kBeltSpeed: {
      const bool met_slack = phase_ == Phase::kFree;
      meet_new_place();
      enter({met_slack ? std::fmin(state.c, 0.0) : state.c, belt_.at(0.0)}, !met_slack);
      return;
    }
    case Ending::kUnloaded:
      enter({0.0, phase_ == Phase::kStick ? belt_.at(0.0) : std::fmin(state.rate, 0.0)}, false);
      return;
    case Ending::kTouchesCoupling:
      enter({0.0, phase_ == Phase::kRide ? belt_.at(0.0) : std::fmax(state.rate, 0.0)}, false);
      return;
    case Ending::kNewPlace:
      meet_new_place();
      enter(state, false);
      return;
    case Ending::kSegment:
      enter({state.c, rides_from_start ? belt_.at(0.0) : state.rate}, false);
      return;
    case Ending::kFreshStart:
      begun_ = state;
      begin_sliding();
      return;
  }
}

std::unique_ptr<NumericMotion> make_sliding_motion(const Motion& motion, double scan_rate_Hz, double accuracy,
                                                   MotionObserver* observer) {
  return std::make_unique<SlidingMotion>(motion, scan_rate_Hz, accuracy, observer);
}

}  // namespace stickslip::sim
