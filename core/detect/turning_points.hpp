/// \file
/// S and K of a slip from its turning points, by closed forms.
#pragma once

#include <optional>
#include <span>

#include "core/estimate/cycle_buffer.hpp"
#include "core/model/oscillator.hpp"

namespace stickslip::detect {

struct TurningPoint {
  double time_s = 0.0;
  double value = 0.0;
};

/// Vertex of the parabola that fits the points in [near_s − reach_s, near_s + reach_s) best.
/// \param sign  +1 for a maximum, −1 for a minimum.
/// \return nullopt with fewer than three points, with the wrong sign of curvature, or if the vertex lies
/// outside the interval.
[[nodiscard]] std::optional<TurningPoint> parabola_vertex(std::span<const estimate::CyclePoint> points,
                                                          double near_s, double reach_s,
                                                          double sign) noexcept;

/// Slope of the points with values between `low` and `high`, with Huber's weights about their median line: a
/// fast loading has few points, and one missed spike would change the slope by 10 %.
/// \param sigma  noise of one scan.
/// \return 1/s; nullopt without two points there at different times; the slope of the median line if half of
/// the points or more are off it, or off the fit, by more than estimate::kStraySigmas.
[[nodiscard]] std::optional<double> slope_between(std::span<const estimate::CyclePoint> points, double low,
                                                  double high, double sigma) noexcept;

/// K from a maximum and the minimum half an oscillation later, whose distance from K is smaller by the factor
/// e^(−πγ/2ω).
/// \param oscillator  must oscillate.
[[nodiscard]] double K_of_turning_points(double peak, double trough,
                                         const model::Oscillator& oscillator) noexcept;

/// Parameters of a slip from its peak force.
struct SlipOfPeak {
  double delta_mu = 0.0;          ///< S − K ≥ 0; 0 if the peak is lower than that for S = K.
  double peak_time_s = 0.0;       ///< t₁, from the onset to the peak.
  double slip_speed_ratio = 0.0;  ///< Largest slip speed over drive speed, −c′/r [18].
};
/// Finds the slip whose force peaks at this height: solves the closed form of the peak, [2] with damping
/// [17], for S − K.
/// \param peak_above_K  peak less K, > 0. \param stick_rate_per_s  r > 0. \param oscillator  must oscillate.
[[nodiscard]] SlipOfPeak slip_of_peak(double peak_above_K, double stick_rate_per_s,
                                      const model::Oscillator& oscillator) noexcept;

}  // namespace stickslip::detect
