/// \file
/// Motion of the sled with rate-and-state friction: one equation for stick and slip, without distinct modes.
///
/// Modes are assigned by thresholds of the sliding speed |V|, to compare a detector with. There are two, so
/// that neither rounding nor steady creep near one of them causes events:
///     slip onset  |V| rises through half the belt's speed. A slip accelerates exponentially, so that this
///                 is the peak of the force within the time of a few e-foldings, and a sled that comes to
///                 slide steadily (V = belt speed) crosses it too.
///     capture     |V| falls through a hundredth of it: the sled moves with the belt. A ring-down whose
///                 speed stays above never counts as sticking again, as with Coulomb friction.
/// At the start of a piece of the motion the mode follows |V| by the same thresholds, but without onset or
/// capture. So a belt that starts or stops at once begins a slip that is no onset.
/// The belt's speed here is |v| at the start of the present piece of the motion, but never less than a
/// hundredth of the highest |v| at the ends of the belt's segments, also while the belt rests.
/// K is the coefficient of steady sliding at that speed, or μ₀ if that speed is 0. S is the coefficient of
/// the spring at the start of the mode, thus at the onset of a slip, but at least K.
///
/// A run starts with a contact that has not rested. Ageing law: θ = 10⁻³ accuracy/ω₀, so short that the
/// motion does not differ from that with θ = 0; with the accuracy asked for where ToleranceChoice's is
/// infinite. Slip law: θ of a contact that does not slide never changes, so that θ = 0 would be no friction
/// for ever; the run starts with θ = D_c/V₀, which gives μ₀.
///
/// |V| is not smooth at V = 0, but there V is exponentially small in x: the step control copes, and a
/// change of sign is no event.
#pragma once

#include <optional>

#include "core/sim/belt_walk.hpp"
#include "core/sim/cvode.hpp"
#include "core/sim/numeric_motion.hpp"
#include "core/sim/rate_and_state_system.hpp"

namespace stickslip::sim {

/// NumericMotion of a motion with rate_and_state. Aborts if it also has velocity_dependence or kinetic_drift;
/// ignores S, K, `paper`, damper_counts_at_onset and the seed.
class RateAndStateMotion final : public NumericMotion {
 public:
  RateAndStateMotion(const Motion& motion, double scan_rate_Hz, double accuracy, MotionObserver* observer);

  void restart(std::uint64_t seed) override;
  [[nodiscard]] const ScanTime& known_from() const override { return known_from_; }
  [[nodiscard]] const ScanTime& known_to() const override { return known_to_; }
  [[nodiscard]] SpringForce force_at(const ScanTime& instant) const override;
  void advance() override;
  [[nodiscard]] SolverMethod method() const override;

 private:
  enum class Ending { kOngoing, kNoForce, kSegment, kFreshStart };

  [[nodiscard]] OdeState state_at(double t_s) const;
  [[nodiscard]] double sliding_speed_m_per_s(const OdeState& y) const {
    return system_.speed_m_per_s(y[1], y[2]);
  }
  /// The belt's, or what stands for it.
  [[nodiscard]] double speed_scale_m_per_s() const;
  /// The sled keeps its speed and the belt gets another.
  void change_belt(OdeState& y, double rate_before) const;
  /// \param y  with c = 0 it may be moved off zero by nothing that matters.
  [[nodiscard]] bool becomes_taut(OdeState& y);
  void begin(OdeState y);
  void look_for_events();
  void name_mode(model::Mode mode, bool onset, bool capture, const ScanTime& time, const OdeState& y);
  void pass_end();

  Motion motion_;
  double scan_rate_Hz_;
  MotionObserver* observer_;
  double omega0_rad_per_s_;
  double per_metre_;  ///< ω₀²/g
  ToleranceChoice choice_;
  double first_psi_;  ///< ln(V₀ θ/D_c) of the contact that a run starts with.
  double fastest_belt_m_per_s_ = 0.0;
  BeltWalk walk_;
  RateAndStateSystem system_;
  Cvode cvode_;

  ScanTime start_;  ///< Of the present piece.
  ScanTime known_from_;
  ScanTime known_to_;
  OdeState begun_{};
  BeltRate belt_;
  bool taut_ = true;
  std::optional<model::Mode> mode_;
  Ending ending_ = Ending::kOngoing;
  double solved_s_ = 0.0;  ///< From start_ to known_to_.
};

}  // namespace stickslip::sim
