/// \file
/// The equations of a sled on a rate-and-state contact, for CVODE.
///
/// The unknowns are y = (c, x, ψ): the coefficient of the spring, the coefficient of friction x = μ(V, θ),
/// and ψ = ln(V₀θ/D_c). The speed of sliding, belt less sled, follows from the law solved for V,
///     V = 2 V₀ e^(−(μ₀ + bψ)/a) sinh(x/a),
/// so that it keeps all its digits from 1e-300 m/s to metres per second and may pass through zero. Taken as
/// an unknown itself, or as belt speed less sled speed, it would lose them as soon as the sled sticks.
///     c′ = r − V ω₀²/g,   ψ′ by the law of ageing or slip,
///     x′ = (v′ + g (c − x) + γ (v − V))/(∂V/∂x) + b tanh(x/a) ψ′,
/// the last from m V′ = m v′ + k l + m γ l′ − μ m g. While the sled sticks ∂V/∂x is tiny and x follows c at
/// once: stiff, and solved implicitly with the Jacobian below.
/// [regularised law: Lapusta, Rice, Ben-Zion and Zheng, J. Geophys. Res. 105(B10):23765–23789, 2000]
#pragma once

#include "core/sim/belt_rate.hpp"
#include "core/sim/cvode.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// OdeSystem with the state (c, x, ψ).
class RateAndStateSystem final : public OdeSystem {
 public:
  /// Which event is which.
  enum : std::size_t {
    kNoForce,   ///< c meets zero: from above in a taut coupling, from below in a slack one.
    kFast,      ///< |V| rises to Piece::fast_m_per_s.
    kCaughtUp,  ///< |V| falls to Piece::caught_up_m_per_s.
  };
  struct Piece {
    bool taut = true;
    bool watches_force = false;      ///< Is kNoForce an event?
    double fast_m_per_s = 0.0;       ///< Threshold of kFast; 0: not an event.
    double caught_up_m_per_s = 0.0;  ///< Of kCaughtUp; 0: not an event.
    BeltRate belt;
  };

  RateAndStateSystem(const RateAndState& law, const model::Oscillator& oscillator, double gravity_m_per_s2);

  /// Sets the piece that all functions below refer to; its belt rate is that from t = 0 on.
  void begin(const Piece& piece) { piece_ = piece; }

  [[nodiscard]] OdeState rate(double t_s, const OdeState& y) const override;
  [[nodiscard]] Jacobian jacobian(double t_s, const OdeState& y) const override;
  [[nodiscard]] Events events(double t_s, const OdeState& y) const override;

  /// V. \param friction  x. \param psi  ψ.
  [[nodiscard]] double speed_m_per_s(double friction, double psi) const;
  /// x = μ(V, θ). \param psi  ψ.
  [[nodiscard]] double friction(double speed_m_per_s, double psi) const;
  /// c″, 1/s².
  [[nodiscard]] double acceleration(double t_s, const OdeState& y) const;

 private:
  struct Speed {
    double value;
    double by_friction;  ///< ∂V/∂x
  };
  struct Ageing {
    double rate;
    double by_friction;
    double by_psi;
  };
  [[nodiscard]] Speed speed(double friction, double psi) const;
  [[nodiscard]] Ageing ageing(const Speed& speed, double psi) const;
  /// V′
  [[nodiscard]] double sliding_acceleration(double t_s, const OdeState& y, double speed_m_per_s) const;

  RateAndState law_;
  double gamma_per_s_;
  double gravity_m_per_s2_;
  double per_metre_;  ///< ω₀²/g
  Piece piece_;
};

}  // namespace stickslip::sim
