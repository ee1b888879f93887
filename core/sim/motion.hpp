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
  double duration_s = 0.0;     ///< ≥ 0; may be infinite.
  double speed_m_per_s = 0.0;  ///< Negative: the carriage returns.
  /// The belt stops for the rest of the segment as soon as the spring's force is zero or less, which may be
  /// at its start.
  bool halt_when_unloaded = false;
  double acceleration_m_per_s2 = 0.0;
  double jerk_m_per_s3 = 0.0;
  double decaying_speed_m_per_s = 0.0;  ///< −speed: a motor that starts from rest.
  double time_constant_s = 1.0;         ///< > 0
};

/// Effect `kinetic_drift` (motion): K of each contact is multiplied by f(x), where x is the time since scan
/// 0, or the net belt travel ∫v dt since then, which decreases where the belt returns. S − K of the contact
/// stays, so S changes by the same amount as K.
///     linear       f = 1 + change · x/scale
///     exponential  f = 1 + change · (1 − e^(−x/scale))
struct KineticDrift {
  enum class Form { kLinear, kExponential };
  enum class Over { kTime, kBeltTravel };
  Form form = Form::kLinear;
  Over over = Over::kTime;
  double change = 0.0;  ///< Relative, of K; such that f ≥ 0 throughout the motion.
  double scale = 1.0;   ///< > 0; s, or m of belt travel.
};

/// Effects `velocity_dependence` and `stribeck` (motion): while the sled slides at V = |belt − sled|, m/s,
///     K(V) = K + per_speed · V + stribeck_rise · e^(−(V/stribeck_speed)^stribeck_exponent).
/// A drift of K changes the first term alone.
/// [Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30(7):1083–1138, 1994, (4)]
struct VelocityDependence {
  /// Any sign. Below zero friction decreases with speed; nothing keeps K(V) ≥ 0.
  double per_speed_s_per_m = 0.0;
  /// Increase of K at V → 0; from 0 to S − K. A contact with a smaller S − K has that as its increase.
  double stribeck_rise = 0.0;
  double stribeck_speed_m_per_s = 1.0;  ///< > 0
  double stribeck_exponent = 1.0;       ///< > 0; 1 (Tustin), 2 (Gaussian).
};

/// Effect `rate_and_state` (motion): law of friction in place of S and K, regularised at V = 0:
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
  double mu_s = 0.0;              ///< S ≥ mu_k
  double mu_k = 0.0;              ///< K ≥ 0
  double gravity_m_per_s2 = 0.0;  ///< > 0
  /// Slip starts when spring and damper together reach S; false: when the spring has reached S, and spring
  /// and damper together K. The share a/g of the belt's acceleration a is added in either case.
  bool damper_counts_at_onset = false;
  PaperSettings paper;            ///< Effects that vary S and K.
  bool one_way_coupling = false;  ///< The coupling cannot push: it goes slack, without force.
  std::vector<BeltSegment> belt;  ///< In the order of time, from scan 0; the belt rests after the last.
  /// Slack of the coupling at scan 0, ≥ 0; above zero only with one_way_coupling. A sled with slack begins at
  /// the speed at which the first segment begins, even if that has no length; with rate_and_state it begins
  /// at rest, as does every sled without slack.
  double startup_slack_m = 0.0;
  std::optional<KineticDrift> kinetic_drift;
  std::optional<VelocityDependence> velocity_dependence;  ///< Only for NumericSolver.
  /// Only for NumericSolver; replaces S, K, `paper` and damper_counts_at_onset. Not together with
  /// kinetic_drift or velocity_dependence.
  std::optional<RateAndState> rate_and_state;
};

/// Start of a piece of the motion. The mode may be that of the piece before. What mode, onset, capture, S and
/// K mean for rate-and-state friction: rate_and_state_motion.hpp.
struct ModeStart {
  ScanTime time;
  model::Mode mode = model::Mode::kStick;
  /// A slip from the belt's speed, because the contact gave way; perhaps at once, without a stick before.
  bool onset = false;
  bool capture = false;  ///< The slip before ended because the sled had reached the belt's speed.
  /// S and K of the present contact, with drift, without dependence on speed. From the contact's onset on, S
  /// is the limit that was reached, with ageing; before, S is without ageing.
  Coefficients paper;
  double coefficient = 0.0;  ///< F/(m g) of the spring; of a slack coupling minus the slack times ω₀²/g.
};

/// Receives the starts of the pieces, in the order of time; with rate_and_state only those that change the
/// mode. The first comes when a solver is constructed or restarted. A numeric solver may tell a start that
/// lies later than the instant it was asked for.
class MotionObserver {
 public:
  virtual ~MotionObserver() = default;
  virtual void mode_began(const ModeStart& start) = 0;
};

/// Interval of time in which the force, as a coefficient, is c(t) = h(t) + course(t), with t from its start.
struct ForceStretch {
  double duration_s = 0.0;
  ExponentialPolynomial course;
  /// Value and rate at the start of the oscillation h, h″ = −ω₀² h − γ h′; zero if there is none.
  double wave = 0.0;
  double wave_rate_per_s = 0.0;
};

/// Receives the continuous force, as consecutive ForceStretch intervals without gaps.
class ForceFollower {
 public:
  virtual ~ForceFollower() = default;
  virtual void follow(const ForceStretch& stretch) = 0;
};

}  // namespace stickslip::sim
