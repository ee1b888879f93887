/// \file
/// Stick, slip and slack of Coulomb friction: sticking from the closed form of the belt's travel,
/// sliding by CVODE. The change from one to the other is an event; friction is not smoothed there.
#pragma once

#include "core/sim/belt_walk.hpp"
#include "core/sim/cvode.hpp"
#include "core/sim/numeric_motion.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/sliding_system.hpp"

namespace stickslip::sim {

/// NumericMotion with Coulomb friction. A piece of the motion has one phase and a time of its own, which
/// starts at zero. Ignores rate_and_state.
class SlidingMotion final : public NumericMotion {
 public:
  SlidingMotion(const Motion& motion, double scan_rate_Hz, double accuracy, MotionObserver* observer);

  void restart(std::uint64_t seed) override;
  [[nodiscard]] const ScanTime& known_from() const override { return known_from_; }
  [[nodiscard]] const ScanTime& known_to() const override { return known_to_; }
  [[nodiscard]] SpringForce force_at(const ScanTime& instant) const override;
  void advance() override;
  [[nodiscard]] SolverMethod method() const override;

 private:
  /// Phase of the motion: kSlower and kFaster are slips, kFree and kRide are slack.
  enum class Phase { kStick, kSlower, kFaster, kFree, kRide };
  /// Event that ends the present piece; kOngoing until CVODE has found it.
  enum class Ending {
    kOngoing,
    kGivesWay,
    kBeltSpeed,
    kUnloaded,
    kTouchesCoupling,
    kNewPlace,
    kSegment,
    kFreshStart
  };
  struct State {
    double c = 0.0;  ///< Below zero with one-way coupling: the slack, as a coefficient.
    double rate = 0.0;
  };
  struct GivingWay;

  [[nodiscard]] static bool slides(Phase phase) { return phase != Phase::kStick && phase != Phase::kRide; }
  [[nodiscard]] static bool slack(Phase phase) { return phase == Phase::kFree || phase == Phase::kRide; }

  [[nodiscard]] ScanTime time(double t_s) const { return start_.later(t_s * scan_rate_Hz_); }
  [[nodiscard]] State state_at(double t_s) const;
  [[nodiscard]] double rested_s() const { return start_.periods_since(contact_start_) / scan_rate_Hz_; }
  [[nodiscard]] double stribeck_rise() const;
  /// S, and K at the start of sliding.
  [[nodiscard]] Coefficients limits(double t_s) const;
  [[nodiscard]] Coefficients observed_paper() const;
  [[nodiscard]] double onset_share(double t_s) const;

  void look_at_belt();
  void enter(State state, bool capture);
  [[nodiscard]] Phase phase_at_belt_speed(double c) const;
  void begin(Phase phase, State state, bool onset, bool capture);
  void plan_rest();
  [[nodiscard]] std::optional<double> gives_way_s(double sign, double longest_s) const;
  void begin_sliding();
  void slide_on();
  void end_at(Ending ending, double t_s);
  void meet_new_place();
  void pass_end();

  Motion motion_;
  double scan_rate_Hz_;
  MotionObserver* observer_;
  double omega0_squared_;
  ToleranceChoice choice_;
  bool stiff_;
  Paper paper_;
  double place_length_;      ///< Correlation length in units of the coefficient.
  double place_left_ = 0.0;  ///< Still to slide until a new place.
  BeltWalk walk_;
  SlidingSystem system_;
  Cvode cvode_;

  ScanTime start_;  ///< Of the present piece.
  ScanTime contact_start_;
  ScanTime known_from_;
  ScanTime known_to_;
  Phase phase_ = Phase::kStick;
  State begun_;        ///< State at start_.
  BeltRate belt_;      ///< From start_ on,
  DriftFactor drift_;  ///< this too.
  Ending ending_ = Ending::kOngoing;
  double solved_s_ = 0.0;      ///< From start_ to known_to_.
  long undecided_before_ = 0;  ///< The present run.
};

}  // namespace stickslip::sim
