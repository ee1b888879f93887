/// \file
/// The equation of a sled that slides one way on the belt, for CVODE.
#pragma once

#include <optional>

#include "core/sim/belt_walk.hpp"
#include "core/sim/cvode.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// OdeSystem with the state y = (c, c′/ω₀) and
///     c″ + γ c′ + ω₀² (c − σ K(V)) = 0 in a taut coupling, c″ = σ ω₀² K(V) in a slack one,
/// σ = +1 where the sled is slower than the belt, −1 where it is faster, V = σ (r − c′) g/ω₀².
class SlidingSystem final : public OdeSystem {
 public:
  /// Which event is which.
  enum : std::size_t {
    kBeltSpeed,  ///< c′ meets r.
    kNoForce,    ///< c meets zero: from above in a taut coupling, from below in a slack one.
    kNewPlace    ///< The sled has slid as far as a place is long.
  };
  struct Piece {
    double sign = 1.0;  ///< σ
    bool taut = true;
    bool watches_force = false;  ///< Is kNoForce an event?
    double begun_c = 0.0;
    double mu_k = 0.0;           ///< K of the contact before the drift.
    double stribeck_rise = 0.0;  ///< In place of that of the law.
    double place_left = 0.0;     ///< Still to slide, in units of the coefficient; may be infinite.
    BeltRate belt;
    DriftFactor drift;
  };

  SlidingSystem(const model::Oscillator& oscillator, double gravity_m_per_s2,
                const std::optional<VelocityDependence>& law);

  /// Sets the piece that all functions below refer to; its belt and drift are those from t = 0 on.
  void begin(const Piece& piece) { piece_ = piece; }
  /// Sets the expected error of c′ − r, 1/s: the doubt of kBeltSpeed.
  void set_doubt(double doubt_per_s) { doubt_per_s_ = doubt_per_s; }
  [[nodiscard]] const Piece& piece() const noexcept { return piece_; }

  [[nodiscard]] OdeState rate(double t_s, const OdeState& y) const override;
  [[nodiscard]] Jacobian jacobian(double t_s, const OdeState& y) const override;
  [[nodiscard]] Events events(double t_s, const OdeState& y) const override;
  /// c″, 1/s².
  [[nodiscard]] double acceleration(double t_s, const OdeState& y) const;
  /// How far the sled has slid since the piece began, in units of the coefficient.
  [[nodiscard]] double slid(double t_s, double c) const;

 private:
  struct Friction {
    double value;
    double slope;  ///< By σ(r − c′), s
  };
  [[nodiscard]] Friction friction(double t_s, double c_rate) const;

  double gamma_per_s_;
  double omega0_rad_per_s_;
  double metres_;  ///< g/ω₀²: what a unit of the coefficient is in metres of extension.
  std::optional<VelocityDependence> law_;
  double doubt_per_s_ = 0.0;
  Piece piece_;
};

}  // namespace stickslip::sim
