#include "core/signal/cubic_outlier.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace stickslip::signal {
namespace {

using Window = std::array<double, kCubicWindow>;

constexpr std::size_t kMiddleScan = 3;

/// Orthonormal polynomial of degree 5 over seven points: 0 in the middle, so that no outlier there explains
/// it.
Window fifth_degree(double size) {
  Window window{-1.0, 4.0, -5.0, 0.0, 5.0, -4.0, 1.0};
  for (double& value : window) value *= size / std::sqrt(84.0);
  return window;
}

/// Part of an outlier that the cubic does not follow: one less the leverage of the middle, 7/21.
constexpr double kMiddleMisfit = 2.0 / 3.0;

// An outlier in the middle leaves what it does not explain: one twentieth of the misfit at most.
TEST(CubicOutlier, LeavesATwentiethOfTheMisfit) {
  for (const auto& [unexplained, is_outlier] : {std::pair{0.045, true}, std::pair{0.055, false}}) {
    const double all = kMiddleMisfit / (1.0 - unexplained);
    Window window = fifth_degree(std::sqrt(unexplained * all));
    window[kMiddleScan] += 1.0;
    const auto outlier = cubic_outlier(window, 1e-9);
    ASSERT_EQ(outlier.has_value(), is_outlier) << unexplained;
    if (is_outlier) {
      EXPECT_NEAR(*outlier, 1.0, 1e-12);
    }
  }
}

// Noise alone leaves 9.21 σ² once in a hundred times: χ² with two degrees of freedom, e^(−9.21/2) = 0.01.
TEST(CubicOutlier, NoiseMayRemain) {
  const double limit = -2.0 * std::log(0.01);
  for (const auto& [part, is_outlier] : {std::pair{0.98, true}, std::pair{1.02, false}}) {
    Window window = fifth_degree(std::sqrt(part * limit));
    window[kMiddleScan] += 8.0;
    EXPECT_EQ(cubic_outlier(window, 1.0).has_value(), is_outlier) << part;
  }
}

TEST(CubicOutlier, ExceedsFiveStandardDeviations) {
  for (const auto& [sigmas, is_outlier] : {std::pair{4.99, false}, std::pair{5.01, true}}) {
    Window window{};
    window[kMiddleScan] = sigmas / std::sqrt(kMiddleMisfit);
    EXPECT_EQ(cubic_outlier(window, 1.0).has_value(), is_outlier) << sigmas;
    EXPECT_EQ(follows_a_cubic(window, 1.0), !is_outlier) << sigmas;
  }
}

// One degree of freedom is left after two outliers: they stand out of a curved course by one and a half of
// its second differences.
TEST(CubicOutlier, TwoExceedTheCurvature) {
  for (const auto& [curvatures, is_outlier] : {std::pair{1.45, false}, std::pair{1.55, true}}) {
    Window window{};
    for (std::size_t k = 0; k < window.size(); ++k) {
      const double x = static_cast<double>(k) - 3.0;
      window[k] = 0.5 * x * x;  // Its second difference is 1.
    }
    window[kMiddleScan] += curvatures;
    window[kMiddleScan + 2] -= curvatures;
    const auto outlier = cubic_outlier(window, 1e-9);
    ASSERT_EQ(outlier.has_value(), is_outlier) << curvatures;
    if (is_outlier) {
      EXPECT_NEAR(*outlier, curvatures, 1e-9);
    }
  }
}

// A second outlier costs (5 σ)², too. Of a, two scans behind the middle, the one in the middle leaves
// G₅₅ − G₃₅²/G₃₃ = 23/42 − (1/7)²/(2/3) of a², with G the projection beyond the cubic, and takes G₃₅/G₃₃ =
// −3/14 of a into its own height.
TEST(CubicOutlier, TheSecondHasItsPrice) {
  constexpr double kHeight = 60.0;
  constexpr double kLeft = 23.0 / 42.0 - 3.0 / 98.0;
  for (const auto& [part, counts] : {std::pair{0.95, false}, std::pair{1.05, true}}) {
    const double other = kOutlierSigmas * std::sqrt(part / kLeft);
    Window window{};
    window[kMiddleScan] = kHeight;
    window[kMiddleScan + 2] = other;
    const auto outlier = cubic_outlier(window, 1.0);
    ASSERT_TRUE(outlier) << part;
    EXPECT_NEAR(*outlier, counts ? kHeight : kHeight - 3.0 / 14.0 * other, 1e-9) << part;
  }
}

}  // namespace
}  // namespace stickslip::signal
