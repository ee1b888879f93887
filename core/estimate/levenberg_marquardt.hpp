/// \file
/// Damping parameter λ of Levenberg–Marquardt steps [J. Soc. Ind. Appl. Math. 11:431–441, 1963]: start and
/// limits common to all fits. Each fit has its own factors by which λ changes.
#pragma once

namespace stickslip::estimate {

inline constexpr double kFirstDamping = 1e-3;      ///< Initial λ: nearly a Gauss–Newton step.
inline constexpr double kSmallestDamping = 1e-12;  ///< Lower limit of λ: negligible beside the curvature.
inline constexpr double kHopeless = 1e8;           ///< Upper limit of λ, at which the fit gives up.

}  // namespace stickslip::estimate
