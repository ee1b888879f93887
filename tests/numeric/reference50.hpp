/// \file
/// The model once more in 50 digits, straight from the paper's formulas: what the stable forms are
/// compared with.
#pragma once

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_dec_float.hpp>

namespace stickslip::numeric {

using Real = boost::multiprecision::cpp_dec_float_50;

inline Real pi50() { return boost::math::constants::pi<Real>(); }

/// c(t) of [11] solved from the characteristic equation; any ω².
struct Reference {
  Real K, D, r, gamma, omega_squared;

  [[nodiscard]] Real value(const Real& t) const {
    return K + exp(-gamma * t / 2) * (D * cosine(t) + (r + gamma * D / 2) * sine(t));
  }
  [[nodiscard]] Real rate(const Real& t) const {
    const Real omega0_squared = omega_squared + gamma * gamma / 4;
    return exp(-gamma * t / 2) * (r * cosine(t) - (gamma * r / 2 + omega0_squared * D) * sine(t));
  }

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
};

}  // namespace stickslip::numeric
