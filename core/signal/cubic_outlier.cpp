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
  return outlier;
}

}  // namespace stickslip::signal
