/// \file
/// The damped oscillation in 50 digits, directly from the paper's formulas and without regard to
/// cancellation: reference for the stable forms in double precision.
///
///     const Oscillation50 slip{K, D, r, gamma, omega_squared};
///     const std::optional<Real> capture = slip.first_rise_of_rate(belt_rate);
#pragma once

#include <optional>

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_dec_float.hpp>

namespace stickslip::accuracy {

using Real = boost::multiprecision::cpp_dec_float_50;

[[nodiscard]] inline Real pi50() { return boost::math::constants::pi<Real>(); }

/// c(t) of [11], solved from the characteristic equation; any ω². c(0) = K + D, c′(0) = r. The functions that
/// seek a first time require γ ≥ 0 and ω₀² > 0.
struct Oscillation50 {
  Real K, D, r, gamma, omega_squared;

  [[nodiscard]] Real value(const Real& t) const {
    return K + exp(-gamma * t / 2) * (D * cosine(t) + (r + gamma * D / 2) * sine(t));
  }
  [[nodiscard]] Real rate(const Real& t) const {
    return exp(-gamma * t / 2) * (r * cosine(t) - (gamma * r / 2 + omega0_squared() * D) * sine(t));
  }
  [[nodiscard]] Real omega0_squared() const { return omega_squared + gamma * gamma / 4; }

  /// First t > 0 at which c rises to `level`, or falls to it; nothing if it never does.
  /// \param level  > c(0) for a rise, < c(0) for a fall; = c(0) only if c first goes the other way.
  [[nodiscard]] std::optional<Real> first_rise(const Real& level) const;
  [[nodiscard]] std::optional<Real> first_fall(const Real& level) const;
  /// First t > 0 at which c′ rises to `level`, or falls to it. \param level  as above, with c′(0) for c(0).
  [[nodiscard]] std::optional<Real> first_rise_of_rate(const Real& level) const;
  [[nodiscard]] std::optional<Real> first_fall_of_rate(const Real& level) const;

 private:
  [[nodiscard]] Real cosine(const Real& t) const {
    if (omega_squared > 0) return cos(sqrt(omega_squared) * t);
    return cosh(sqrt(Real(-omega_squared)) * t);
  }
  [[nodiscard]] Real sine(const Real& t) const {
    if (omega_squared == 0) return t;
    if (omega_squared > 0) return sin(sqrt(omega_squared) * t) / sqrt(omega_squared);
    const Real kappa = sqrt(Real(-omega_squared));
    return sinh(kappa * t) / kappa;
  }
  /// c − K and its derivative as oscillations about zero; mirrored if `sign` is −1.
  [[nodiscard]] Oscillation50 about_zero(int sign) const;
  [[nodiscard]] Oscillation50 derivative(int sign) const;
  /// First t > 0 at which c′ = 0; then each half period, if it oscillates.
  [[nodiscard]] std::optional<Real> first_extreme() const;
};

}  // namespace stickslip::accuracy
