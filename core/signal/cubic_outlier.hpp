/// \file
/// Which scans of seven spoil a cubic through them?
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace stickslip::signal {

/// Scans of a window for CubicOutlier.
inline constexpr std::size_t kCubicWindow = 7;

/// An outlier must be worth this many standard deviations: noise alone is in 6 of ten million scans.
inline constexpr double kOutlierSigmas = 5.0;

/// Surely no outlier: what a cubic leaves of the seven is worth less. By the orthogonal polynomials of degree
/// 4, 5 and 6 over seven points [Fisher and Yates, Statistical Tables, 1938], in few operations, for every
/// scan; so close to the limit that roundings count it says no, and cubic_outlier() decides.
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

/// Is the middle of seven equidistant values an outlier of the cubic that fits the others best? Tried are
/// the middle, each after it, and each two of these, for a price of (5 σ)² an outlier: values before the
/// middle are taken to be sound. \param sigma  standard deviation of the noise of one value. \return what to
/// subtract from the middle; nothing if it is sound or if the answer is not clear.
[[nodiscard]] std::optional<double> cubic_outlier(std::span<const double, kCubicWindow> window,
                                                  double sigma) noexcept;

}  // namespace stickslip::signal
