/// \file
/// The damping of steps by Levenberg and Marquardt [J. Soc. Ind. Appl. Math. 11:431–441, 1963], as every fit
/// here begins and ends it; by how much it changes on the way is each fit's own.
#pragma once

namespace stickslip::model {

inline constexpr double kFirstDamping = 1e-3;      ///< Nearly Gauss's and Newton's step: guesses are good.
inline constexpr double kSmallestDamping = 1e-12;  ///< Nothing beside the curvature.
inline constexpr double kHopeless = 1e8;           ///< No step is short enough.

}  // namespace stickslip::model
