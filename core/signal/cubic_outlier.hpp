/// \file
/// Outlier test: deviation of the middle of seven scans from a cubic.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace stickslip::signal {

/// Scans of a window.
inline constexpr std::size_t kCubicWindow = 7;

/// Smallest significance of an outlier, in standard deviations; noise alone exceeds it in 6 of ten million
/// scans.
inline constexpr double kOutlierSigmas = 5.0;

/// Fast path: true if the window certainly has no outlier, since its misfit to a cubic is below
/// kOutlierSigmas σ. Computed from the orthogonal polynomials of degree 4, 5 and 6 over seven points [Fisher
/// and Yates, Statistical Tables, 1938]. If it returns false, as also within rounding errors of the limit,
/// cubic_outlier() decides.
[[nodiscard]] inline bool follows_a_cubic(std::span<const double, kCubicWindow> v, double sigma) noexcept {
  constexpr double kRoundings = 1e-9;
  const double outer = v[0] + v[6];
  const double next = v[1] + v[5];
  const double inner = v[2] + v[4];
  const double fourth = 3.0 * outer - 7.0 * next + inner + 6.0 * v[3];
  const double fifth = (v[6] - v[0]) - 4.0 * (v[5] - v[1]) + 5.0 * (v[4] - v[2]);
  const double sixth = outer - 6.0 * next + 15.0 * inner - 20.0 * v[3];
  const double all =
      fourth * fourth * (1.0 / 154.0) + fifth * fifth * (1.0 / 84.0) + sixth * sixth * (1.0 / 924.0);
  return all <= (1.0 - kRoundings) * kOutlierSigmas * kOutlierSigmas * sigma * sigma;
}

/// Tests whether the middle of seven equidistant values is an outlier of the cubic through the others. The
/// candidates are the middle, each value after it, and each pair of these, with a penalty of (5 σ)² for each
/// outlier. The corner of a level and a steep line has none. Values before the middle must be repaired
/// already.
/// \param sigma  standard deviation of the noise of one value.
/// \return height of the outlier, to be subtracted from the middle; nullopt if it is none. One candidate or
/// two must explain 95 % of the misfit, or all but what noise leaves. Each of two must be at least 1.5 times
/// as high as the largest second difference of the repaired window.
[[nodiscard]] std::optional<double> cubic_outlier(std::span<const double, kCubicWindow> window,
                                                  double sigma) noexcept;

}  // namespace stickslip::signal
