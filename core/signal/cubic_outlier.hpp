/// \file
/// Which scans of seven spoil a cubic through them?
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace stickslip::signal {

/// Scans of a window for CubicOutlier.
inline constexpr std::size_t kCubicWindow = 7;

/// Is the middle of seven equidistant values an outlier of the cubic that fits the others best? Tried are
/// the middle, each after it, and each two of these, for a price of (5 σ)² an outlier: values before the
/// middle are taken to be sound. \param sigma  standard deviation of the noise of one value. \return what to
/// subtract from the middle; nothing if it is sound or if the answer is not clear.
[[nodiscard]] std::optional<double> cubic_outlier(const std::array<double, kCubicWindow>& window,
                                                  double sigma) noexcept;

}  // namespace stickslip::signal
