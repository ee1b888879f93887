/// \file
/// Input of the motion solvers (oscillator, friction, belt), and interfaces to observe the motion.
///
///     Motion motion;
///     motion.oscillator = model::Oscillator::from_omega(omega, 0.022);
///     motion.mu_s = 0.35;
///     motion.mu_k = 0.30;
///     motion.gravity_m_per_s2 = 9.80665;
///     motion.belt = {{.duration_s = 10.0, .speed_m_per_s = 0.00508}};
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/model/oscillator.hpp"
#include "core/model/truth.hpp"
#include "core/sim/exponential_polynomial.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// Segment of the belt's motion. At t after the start of the segment its speed is
///     v(t) = speed + acceleration t + jerk t²/2 + decaying_speed e^(−t/time_constant).
struct BeltSegment {
  double duration_s = 0.0;
  double speed_m_per_s = 0.0;  ///< Negative: the carriage returns.
  /// The belt stops for the rest of the segment as soon as the force is zero.
  bool halt_when_unloaded = false;
  double acceleration_m_per_s2 = 0.0;
  double jerk_m_per_s3 = 0.0;
  double decaying_speed_m_per_s = 0.0;  ///< −speed: a motor that starts from rest.
  double time_constant_s = 1.0;         ///< > 0
};

/// Effect `kinetic_drift` (motion): K changes by a factor f(x) of the time since the start of the scene or of
/// the way ∫v dt that the belt has gone since then (back again where it returns); S − K of the contact is
/// unchanged, so S changes by the same amount.
///     linear       f = 1 + change · x/scale
///     exponential  f = 1 + change · (1 − e^(−x/scale))
struct KineticDrift {
  enum class Form { kLinear, kExponential };
  enum class Over { kTime, kBeltTravel };
  Form form = Form::kLinear;
  Over over = Over::kTime;
  double change = 0.0;  ///< Relative, of K; f never goes below zero within the scene.
  double scale = 1.0;   ///< > 0; s, or m of belt travel.
};

/// Effects `velocity_dependence` and `stribeck` (motion): while the sled slides at V = |belt − sled|,
///     K(V) = K + per_speed · V + stribeck_rise · e^(−(V/stribeck_speed)^stribeck_exponent).
/// [Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30(7):1083–1138, 1994, (4)]
struct VelocityDependence {
  double per_speed_s_per_m = 0.0;       ///< Any sign; below zero friction decreases with speed.
  double stribeck_rise = 0.0;           ///< Increase of K at V → 0; from 0 to S − K.
  double stribeck_speed_m_per_s = 1.0;  ///< > 0
  double stribeck_exponent = 1.0;       ///< > 0; 1 (Tustin), 2 (Gaussian).
};

/// Effect `rate_and_state` (motion): friction without S and K of its own, regularised at V = 0:
///     μ(V, θ) = a asinh( V/(2 V₀) · e^((μ₀ + b ln(V₀ θ/D_c))/a) ),
///     ageing law  θ′ = 1 − |V| θ/D_c,    slip law  θ′ = −(|V| θ/D_c) ln(|V| θ/D_c).
/// [Dieterich, J. Geophys. Res. 84(B5):2161–2168, 1979; Ruina, J. Geophys. Res. 88(B12):10359–10370, 1983;
///  Lapusta, Rice, Ben-Zion and Zheng, J. Geophys. Res. 105(B10):23765–23789, 2000 (asinh)]
struct RateAndState {
  enum class Law { kAgeing, kSlip };
  Law law = Law::kAgeing;
  double a = 0.0;                        ///< > 0
  double b = 0.0;                        ///< ≥ 0
  double critical_slip_m = 0.0;          ///< D_c > 0
  double reference_speed_m_per_s = 0.0;  ///< V₀ > 0
  double mu_0 = 0.0;                     ///< ≥ 0; of steady sliding at V₀.
};

/// All parameters of the motion.
struct Motion {
  model::Oscillator oscillator;
  double mu_s = 0.0;  ///< S ≥ mu_k
  double mu_k = 0.0;  ///< K ≥ 0
  double gravity_m_per_s2 = 0.0;
  bool damper_counts_at_onset = false;  ///< Slip starts when spring and damper together hold S.
  PaperSettings paper;                  ///< Variation of S and K from contact to contact.
  bool one_way_coupling = false;
  std::vector<BeltSegment> belt;  ///< In the order of time; the belt rests after the last.
  /// ≥ 0; above zero only with one_way_coupling. At scan 0 the sled moves with the belt, at the speed of the
  /// first segment, even if that has no length.
  double startup_slack_m = 0.0;
  std::optional<KineticDrift> kinetic_drift;
  std::optional<VelocityDependence> velocity_dependence;  ///< Numeric only.
  std::optional<RateAndState> rate_and_state;             ///< Numeric only; replaces S and K.
};

/// Change of the sled's mode.
struct ModeStart {
  ScanTime time;
  model::Mode mode = model::Mode::kStick;
  bool onset = false;        ///< A slip that begins from sticking.
  bool capture = false;      ///< The slip before ended because the sled had reached the belt's speed.
  Coefficients paper;        ///< S and K of the present contact.
  double coefficient = 0.0;  ///< Of the spring; below zero the slack.
};

/// Observer of the changes of mode, called in order.
class MotionObserver {
 public:
  virtual ~MotionObserver() = default;
  virtual void mode_began(const ModeStart& start) = 0;
};

/// Interval of time in which the force has one closed form, c(t) = h(t) + course(t), with t from its start.
struct ForceStretch {
  double duration_s = 0.0;
  ExponentialPolynomial course;
  /// The oscillation h, h″ = −ω₀² h − γ h′, by its value and rate at the start; zero unless the sled slips.
  double wave = 0.0;
  double wave_rate_per_s = 0.0;
};

/// Receiver of the continuous force, as consecutive ForceStretch intervals without gaps.
class ForceFollower {
 public:
  virtual ~ForceFollower() = default;
  virtual void follow(const ForceStretch& stretch) = 0;
};

}  // namespace stickslip::sim
