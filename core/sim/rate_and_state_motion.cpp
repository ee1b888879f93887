#include "core/sim/rate_and_state_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"

namespace stickslip::sim {

using model::Mode;

namespace {

/// Largest error of the coefficient, divided by tolerance and number of cycles (measured).
constexpr double kRateAndStateGrowth = 60.0;
/// Tolerance of x and ψ relative to that of c: V, and with it c′, is exponential in x/a.
constexpr double kTightest = 1e-3;
/// Newton's iteration ends at roundings of c − x.
constexpr double kLeastRateAndStateTolerance = 1e-12;
constexpr double kOnset = 0.5;  // Of the belt's speed; why: the header.
constexpr double kCapture = 0.01;
constexpr double kBeltAtRest = 0.01;
constexpr double kSameSpeed = 1e-10;  // V has the roundings of x over a.
constexpr double kNoWay = 1e-20;
constexpr double kFirstRest = 1e-3;  // Of the accuracy, over ω₀.

double first_psi(const RateAndState& law, double accuracy, double omega0_rad_per_s) {
  if (law.law == RateAndState::Law::kSlip) return 0.0;
  const double rested_s = kFirstRest * accuracy / omega0_rad_per_s;
  return std::log(law.reference_speed_m_per_s * rested_s / law.critical_slip_m);
}

}  // namespace

RateAndStateMotion::RateAndStateMotion(const Motion& motion, double scan_rate_Hz, double accuracy,
                                       MotionObserver* observer)
    : motion_(motion),
      scan_rate_Hz_(scan_rate_Hz),
      observer_(observer),
      omega0_rad_per_s_(std::sqrt(motion.oscillator.omega0_squared())),
      per_metre_(motion.oscillator.omega0_squared() / motion.gravity_m_per_s2),
      choice_(ToleranceChoice::of(motion, accuracy, kRateAndStateGrowth, kLeastRateAndStateTolerance)),
      first_psi_(first_psi(*motion.rate_and_state,
                           std::isfinite(choice_.accuracy) ? choice_.accuracy : accuracy, omega0_rad_per_s_)),
      walk_(motion_, scan_rate_Hz),
      system_(*motion.rate_and_state, motion.oscillator, motion.gravity_m_per_s2),
      cvode_(Cvode::Method::kBdf, system_, 3, 0.1 / omega0_rad_per_s_) {
  STICKSLIP_EXPECTS(!motion.velocity_dependence && !motion.kinetic_drift);
  const RateAndState& law = *motion.rate_and_state;
  const double x = choice_.tolerance * std::clamp(law.a, kTightest, 1.0);
  const double psi = law.b > law.a ? x / law.b : choice_.tolerance;
  cvode_.set_tolerance({choice_.tolerance, x, std::min(psi, choice_.tolerance)});
  for (const BeltSegment& segment : motion.belt) {
    for (const double t_s : {0.0, segment.duration_s}) {
      fastest_belt_m_per_s_ =
          std::max(fastest_belt_m_per_s_, std::abs(BeltRate::of(segment, 1.0, 0.0).at(t_s)));
    }
  }
}

SolverMethod RateAndStateMotion::method() const {
  return {"SUNDIALS CVODE (BDF)", choice_.accuracy * cvode_.widened(), 0};
}

void RateAndStateMotion::restart(std::uint64_t /*seed*/) {
  walk_.restart();
  start_ = {};
  belt_ = walk_.from(start_);
  taut_ = motion_.startup_slack_m == 0.0;
  mode_.reset();
  begin({-motion_.startup_slack_m * per_metre_, 0.0, first_psi_});  // The first segment follows.
}

OdeState RateAndStateMotion::state_at(double t_s) const { return t_s == 0.0 ? begun_ : cvode_.state_at(t_s); }

SpringForce RateAndStateMotion::force_at(const ScanTime& instant) const {
  STICKSLIP_EXPECTS(known_from_ <= instant && instant <= known_to_);
  if (!taut_) return {};
  const double t_s = instant == known_to_ ? solved_s_ : instant.periods_since(start_) / scan_rate_Hz_;
  const OdeState y = state_at(t_s);
  return {motion_.one_way_coupling ? std::fmax(y[0], 0.0) : y[0],
          belt_.at(t_s) - per_metre_ * sliding_speed_m_per_s(y)};
}

double RateAndStateMotion::speed_scale_m_per_s() const {
  return std::max(std::abs(belt_.at(0.0)) / per_metre_, kBeltAtRest * fastest_belt_m_per_s_);
}

void RateAndStateMotion::change_belt(OdeState& y, double rate_before) const {
  const double rate = belt_.at(0.0);
  constexpr double kSameRate = 64.0 * std::numeric_limits<double>::epsilon();
  if (std::abs(rate - rate_before) <= kSameRate * std::max(std::abs(rate), std::abs(rate_before))) return;
  const double speed_m_per_s = sliding_speed_m_per_s(y) + (rate - rate_before) / per_metre_;
  y[1] = system_.friction(speed_m_per_s, y[2]);
}

bool RateAndStateMotion::becomes_taut(OdeState& y) {
  if (!motion_.one_way_coupling || y[0] > 0.0) return true;
  if (y[0] < 0.0) return false;
  const double rate = belt_.at(0.0);
  const double sliding = per_metre_ * sliding_speed_m_per_s(y);
  const double still = kNoWay * omega0_rad_per_s_;
  if (std::abs(rate - sliding) > std::max(still, kSameSpeed * (std::abs(rate) + std::abs(sliding))))
    return rate > sliding;
  // Neither stretched nor stretching: the acceleration decides, and a way too short to matter keeps the
  // roundings of the speeds from being events.
  RateAndStateSystem::Piece piece;
  piece.belt = belt_;
  system_.begin(piece);
  const bool taut = system_.acceleration(0.0, y) >= 0.0;
  y[0] = taut ? kNoWay : -kNoWay;
  return taut;
}

void RateAndStateMotion::begin(OdeState y) {
  taut_ = becomes_taut(y);
  begun_ = y;
  known_from_ = start_;
  known_to_ = start_;
  solved_s_ = 0.0;
  const double speed = std::abs(sliding_speed_m_per_s(y));
  if (!taut_) {
    name_mode(Mode::kSlack, false, false, start_, y);
  } else if (mode_ != Mode::kSlip ? speed >= kOnset * speed_scale_m_per_s() && speed > 0.0
                                  : speed > kCapture * speed_scale_m_per_s()) {
    name_mode(Mode::kSlip, false, false, start_, y);
  } else {
    name_mode(Mode::kStick, false, false, start_, y);
  }
  look_for_events();
  if (walk_.left_s(start_) > 0.0) {
    ending_ = Ending::kOngoing;
    cvode_.restart(y);
  } else {
    ending_ = Ending::kSegment;
  }
}

void RateAndStateMotion::look_for_events() {
  RateAndStateSystem::Piece piece;
  piece.taut = taut_;
  piece.watches_force = motion_.one_way_coupling || walk_.halts_when_unloaded();
  piece.belt = belt_;
  if (mode_ == Mode::kStick) piece.fast_m_per_s = kOnset * speed_scale_m_per_s();
  if (mode_ == Mode::kSlip) piece.caught_up_m_per_s = kCapture * speed_scale_m_per_s();
  system_.begin(piece);
}

void RateAndStateMotion::name_mode(Mode mode, bool onset, bool capture, const ScanTime& time,
                                   const OdeState& y) {
  if (mode_ == mode) return;
  mode_ = mode;
  if (observer_ == nullptr) return;
  const RateAndState& law = *motion_.rate_and_state;
  const double ratio = speed_scale_m_per_s() / law.reference_speed_m_per_s;
  const double steady = law.mu_0 + (ratio > 0.0 ? (law.a - law.b) * std::log(ratio) : 0.0);
  observer_->mode_began({time, mode, onset, capture, {std::max(y[0], steady), steady}, y[0]});
}

void RateAndStateMotion::advance() {
  if (ending_ != Ending::kOngoing) {
    pass_end();
    return;
  }
  const Cvode::Step step = cvode_.step();
  const double left_s = walk_.left_s(start_);
  known_from_ = known_to_;
  solved_s_ = step.t_s;
  if (step.t_s >= left_s) {
    solved_s_ = left_s;
    known_to_ = walk_.segment_end();
    ending_ = Ending::kSegment;
    return;
  }
  known_to_ = start_.later(step.t_s * scan_rate_Hz_);
  if (!step.event) {
    if (step.t_s > kLongestPiece_s) ending_ = Ending::kFreshStart;
  } else if (*step.event == RateAndStateSystem::kNoForce) {
    ending_ = Ending::kNoForce;
  } else {
    // Nothing happens to the motion: CVODE goes on as if it had not been asked.
    const bool onset = *step.event == RateAndStateSystem::kFast;
    name_mode(onset ? Mode::kSlip : Mode::kStick, onset, !onset, known_to_, state_at(step.t_s));
    look_for_events();
  }
}

void RateAndStateMotion::pass_end() {
  OdeState y = state_at(solved_s_);
  const Ending ending = ending_;
  double rate_before = belt_.at(solved_s_);
  start_ = known_to_;
  if (ending == Ending::kNoForce) y[0] = 0.0;
  if (ending == Ending::kSegment) walk_.next_segment();
  belt_ = walk_.from(start_);
  change_belt(y, rate_before);
  if (walk_.halts_when_unloaded() && y[0] <= 0.0) {
    rate_before = belt_.at(0.0);
    walk_.halt(start_);
    belt_ = walk_.from(start_);
    change_belt(y, rate_before);
  }
  begin(y);
}

std::unique_ptr<NumericMotion> make_rate_and_state_motion(const Motion& motion, double scan_rate_Hz,
                                                          double accuracy, MotionObserver* observer) {
  return std::make_unique<RateAndStateMotion>(motion, scan_rate_Hz, accuracy, observer);
}

}  // namespace stickslip::sim
