/// \file
/// Belt speed as a rate of the coefficient, r = ω₀² v/g: the unit of the solvers.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// Belt rate r(t) = rate + slope t + jerk t²/2 + decaying e^(−t/τ), t after the start of a piece.
struct BeltRate {
  double rate = 0.0;                         ///< 1/s
  double slope = 0.0;                        ///< 1/s²
  double jerk = 0.0;                         ///< 1/s³
  double decaying = 0.0;                     ///< 1/s
  double inverse_time_constant_per_s = 0.0;  ///< 1/τ; 0 if nothing decays.

  /// Rate of a segment; its duration is ignored. \param factor  ω₀²/g, 1/m. \param elapsed_s  time after the
  /// start of the segment at which t is zero.
  [[nodiscard]] static BeltRate of(const BeltSegment& segment, double factor, double elapsed_s) noexcept {
    BeltRate belt;
    belt.rate = factor * (segment.speed_m_per_s + elapsed_s * (segment.acceleration_m_per_s2 +
                                                               elapsed_s * segment.jerk_m_per_s3 / 2.0));
    belt.slope = factor * (segment.acceleration_m_per_s2 + elapsed_s * segment.jerk_m_per_s3);
    belt.jerk = factor * segment.jerk_m_per_s3;
    if (segment.decaying_speed_m_per_s != 0.0) {
      belt.inverse_time_constant_per_s = 1.0 / segment.time_constant_s;
      belt.decaying =
          factor * segment.decaying_speed_m_per_s * std::exp(-elapsed_s * belt.inverse_time_constant_per_s);
    }
    return belt;
  }

  /// r(t), 1/s.
  [[nodiscard]] double at(double t_s) const noexcept {
    return rate + t_s * (slope + t_s * jerk / 2.0) + decay(t_s);
  }
  /// r′(t), 1/s².
  [[nodiscard]] double slope_at(double t_s) const noexcept {
    return slope + t_s * jerk - inverse_time_constant_per_s * decay(t_s);
  }
  /// r″(t), 1/s³.
  [[nodiscard]] double curvature_at(double t_s) const noexcept {
    return jerk + std::pow(inverse_time_constant_per_s, 2) * decay(t_s);
  }
  /// r‴(t), 1/s⁴.
  [[nodiscard]] double third_at(double t_s) const noexcept {
    return -std::pow(inverse_time_constant_per_s, 3) * decay(t_s);
  }
  /// ∫r from 0 to t: the belt travel times ω₀²/g.
  [[nodiscard]] double travel(double t_s) const noexcept {
    const double polynomial = t_s * (rate + t_s * (slope / 2.0 + t_s * jerk / 6.0));
    if (decaying == 0.0) return polynomial;
    return polynomial -
           decaying * std::expm1(-t_s * inverse_time_constant_per_s) / inverse_time_constant_per_s;
  }

  // Upper bounds of |r|, |r′|, |r″| and |r‴| for 0 ≤ from ≤ t ≤ to; without `to`, for all t ≥ from. They need
  // not be reached.
  [[nodiscard]] double most(double from_s, double to_s) const noexcept {
    return std::abs(rate) + std::abs(slope) * to_s + std::abs(jerk) * to_s * to_s / 2.0 +
           std::abs(decay(from_s));
  }
  [[nodiscard]] double most_slope(double from_s, double to_s) const noexcept {
    return std::max(std::abs(slope + from_s * jerk), std::abs(slope + to_s * jerk)) +
           inverse_time_constant_per_s * std::abs(decay(from_s));
  }
  [[nodiscard]] double most_curvature(double from_s) const noexcept {
    return std::abs(jerk) + std::pow(inverse_time_constant_per_s, 2) * std::abs(decay(from_s));
  }
  [[nodiscard]] double most_third(double from_s) const noexcept {
    return std::pow(inverse_time_constant_per_s, 3) * std::abs(decay(from_s));
  }

 private:
  [[nodiscard]] double decay(double t_s) const noexcept {
    return decaying == 0.0 ? 0.0 : decaying * std::exp(-t_s * inverse_time_constant_per_s);
  }
};

}  // namespace stickslip::sim
