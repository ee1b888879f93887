#include "core/signal/cubic_outlier.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stickslip::signal {
namespace {

constexpr std::size_t kMiddle = kCubicWindow / 2;
/// Largest unexplained part of the misfit: one or two outliers must explain the rest. It excludes noise-free
/// signals without a spike, of which an outlier in the middle leaves unexplained: 0.14 of a corner, 0.22 of a
/// step, 0.38 of a jump of the curvature, 0.49 of a cosine of 4 scans a cycle.
constexpr double kUnexplained = 0.05;
/// Misfit in σ² that noise alone leaves after a cubic and one outlier are fitted to seven scans: 99 %
/// quantile of χ² with two degrees of freedom.
constexpr double kNoiseLeaves = 9.21;
/// Smallest height of two outliers, relative to the largest second difference of the repaired window. The
/// misfit alone does not suffice for two, since one degree of freedom is left. Signals without a spike reach
/// at most 0.8 (a cosine of 4.5 scans a cycle or more), 0.9 (corners), 1.0 (a fall within two scans).
constexpr double kCurvatures = 1.5;

/// Projection on the misfit of a cubic. Rows: the orthonormal polynomials of degree 4, 5 and 6 over seven
/// points. [Table of orthogonal polynomials: Fisher and Yates, Statistical Tables, 1938]
const Eigen::Matrix<double, 3, 7>& beyond_cubic() noexcept {
  static const Eigen::Matrix<double, 3, 7> kRows = [] {
    Eigen::Matrix<double, 3, 7> rows;
    rows << 3, -7, 1, 6, 1, -7, 3, -1, 4, -5, 0, 5, -4, 1, 1, -6, 15, -20, 15, -6, 1;
    rows.rowwise().normalize();
    return rows;
  }();
  return kRows;
}

double largest_second_difference(const Eigen::Matrix<double, 7, 1>& values) {
  double largest = 0.0;
  for (Eigen::Index k = 1; k + 1 < values.size(); ++k) {
    largest = std::max(largest, std::abs(values[k - 1] - 2.0 * values[k] + values[k + 1]));
  }
  return largest;
}

/// Line through some scans by least squares.
struct Line {
  double slope = 0.0;
  double slope_variance = 0.0;  ///< In σ².
  double rest = 0.0;            ///< Sum of squares.
};

Line line_through(std::span<const double> values) noexcept {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / count;
  double products = 0.0;
  double squares = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double place = static_cast<double>(k) - 0.5 * (count - 1.0);
    products += place * (values[k] - mean);
    squares += place * place;
    all += (values[k] - mean) * (values[k] - mean);
  }
  const double slope = products / squares;
  return {slope, 1.0 / squares, all - slope * products};
}

/// A level and a steep line, with two scans or more each, explain the window: the tester loads or unloads
/// there. An outlier of the cubic would explain it nearly as well.
bool is_corner(std::span<const double, kCubicWindow> window, double sigma) noexcept {
  constexpr double kLevelErrors = 3.0;   // Standard errors of the slope of what is a level.
  constexpr double kSteepSigmas = 10.0;  // σ a scan; a cubic leaves no outlier of a corner of less than 14.
  constexpr double kNoiseLeavesOfLines = 16.27;  // 99.9 % quantile of χ² with three degrees of freedom.
  for (std::size_t left = 2; left + 2 <= kCubicWindow; ++left) {
    const Line before = line_through(window.first(left));
    const Line after = line_through(window.subspan(left));
    if (before.rest + after.rest > kNoiseLeavesOfLines * sigma * sigma) continue;
    const auto is_level = [sigma](const Line& line) {
      return std::abs(line.slope) <= kLevelErrors * std::sqrt(line.slope_variance) * sigma;
    };
    const auto is_steep = [sigma](const Line& line) { return std::abs(line.slope) >= kSteepSigmas * sigma; };
    if ((is_level(before) && is_steep(after)) || (is_steep(before) && is_level(after))) return true;
  }
  return false;
}

}  // namespace

std::optional<double> cubic_outlier(std::span<const double, kCubicWindow> window, double sigma) noexcept {
  const Eigen::Map<const Eigen::Matrix<double, 7, 1>> values{window.data()};
  const Eigen::Matrix<double, 3, 7>& beyond = beyond_cubic();
  const Eigen::Vector3d misfit = beyond * values;
  const double all = misfit.squaredNorm();
  const double price = kOutlierSigmas * kOutlierSigmas * sigma * sigma;
  if (!(all > price)) return std::nullopt;
  const double left_over = std::max(kUnexplained * all, kNoiseLeaves * sigma * sigma);

  double best = all;
  std::optional<double> outlier;
  for (std::size_t k = kMiddle; k < kCubicWindow; ++k) {
    const auto column = beyond.col(static_cast<Eigen::Index>(k));
    const double height = column.dot(misfit) / column.squaredNorm();
    const double rest = all - height * height * column.squaredNorm();
    if (rest > left_over || rest + price >= best) continue;
    best = rest + price;
    outlier = k == kMiddle ? std::optional{height} : std::nullopt;
  }
  for (std::size_t i = kMiddle; i < kCubicWindow; ++i) {
    for (std::size_t j = i + 1; j < kCubicWindow; ++j) {
      const Eigen::Vector3d first = beyond.col(static_cast<Eigen::Index>(i));
      const Eigen::Vector3d second = beyond.col(static_cast<Eigen::Index>(j));
      const Eigen::Vector3d normal = first.cross(second);
      const double along = misfit.dot(normal);
      const double rest = along * along / normal.squaredNorm();
      if (rest > left_over || rest + 2.0 * price >= best) continue;
      // Cramer's rule in the plane of the two.
      const double height = misfit.dot(second.cross(normal)) / first.dot(second.cross(normal));
      const double other = misfit.dot(first.cross(normal)) / second.dot(first.cross(normal));
      Eigen::Matrix<double, 7, 1> repaired = values;
      repaired[static_cast<Eigen::Index>(i)] -= height;
      repaired[static_cast<Eigen::Index>(j)] -= other;
      const double smallest = std::min(std::abs(height), std::abs(other));
      if (smallest < kCurvatures * largest_second_difference(repaired)) continue;
      best = rest + 2.0 * price;
      outlier = i == kMiddle ? std::optional{height} : std::nullopt;
    }
  }
  return outlier && is_corner(window, sigma) ? std::nullopt : outlier;
}

}  // namespace stickslip::signal
