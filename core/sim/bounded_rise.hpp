/// \file
/// First zero of a smooth function of time, found from a bound of its second derivative.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace stickslip::sim {

/// First t ≥ 0 at which f reaches zero from below; 0 if f(0) > 0; nullopt if there is none up to longest_s.
///
/// Over each interval f lies below the parabola with its value and slope at the start and the largest second
/// derivative in it. So f has no zero before that of the parabola, which is the next point. The points
/// converge to a simple zero like Newton's method, never pass it, and miss no touching of zero.
///
/// \param f          value(t), its derivative slope(t), and a finite bend(from, to) ≥ its second derivative
///                   there. f(0) = 0 does not count if f falls at first.
/// \param longest_s  end of the search; may be very long, but finite.
/// \param stretch_s  > 0, length of the first interval; later ones may be longer.
/// \param rounding   ≥ 0: for t > 0 a value of at least −rounding counts as zero.
template <typename Function>
[[nodiscard]] std::optional<double> bounded_rise_s(const Function& f, double longest_s, double stretch_s,
                                                   double rounding) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // Smallest step after which the parabola is at zero.
  const auto safe_step = [&f](double t, double value, double slope, double to) {
    const double bend = std::fmax(f.bend(t, to), 0.0);
    if (bend == 0.0) return slope > 0.0 ? -value / slope : kNever;
    const double root = std::sqrt(slope * slope - 2.0 * bend * value);
    return slope > 0.0 ? -2.0 * value / (slope + root) : (root - slope) / bend;
  };
  double t = 0.0;
  while (true) {
    const double slope = f.slope(t);
    double value = f.value(t);
    if (t == 0.0) {
      if (value > 0.0 || (value == 0.0 && slope > 0.0)) return 0.0;
    } else if (value >= -rounding) {
      return t;
    }
    value = std::fmin(value, 0.0);
    double step = 0.0;
    // The last one is for a function that leaves zero with a high power of t: only near zero is its bend
    // small.
    for (const double to : {longest_s, std::fmin(t + stretch_s, longest_s), std::fmin(2.0 * t, longest_s)}) {
      if (to <= t) continue;
      const double safe = safe_step(t, value, slope, to);
      if (t + safe > longest_s && to == longest_s) return std::nullopt;
      step = std::fmax(step, std::fmin(safe, to - t));
    }
    if (!(t < longest_s)) return std::nullopt;
    if (t > 0.0 && step <= kEpsilon * t) return t;
    if (step == 0.0) step = kEpsilon * stretch_s;  // Zero, level and bent: on to where it shows how.
    if (step >= stretch_s) stretch_s *= 2.0;
    t += step;
  }
}

}  // namespace stickslip::sim
