#include "core/law/line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>

namespace stickslip::law {
namespace {

struct Solution {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double middle = 0.0;  ///< Of the places, weighted.
  double at_middle = 0.0;
  double middle_variance = 0.0;
  Leftover left;
};

/// About the weighted middle of the places, where level and slope are independent.
Solution solve(std::span<const Point> points, bool with_slope, double between_variance) {
  double weights = 0.0;
  double middle = 0.0;
  double level = 0.0;
  const auto weight = [&](const Point& point) {
    return 1.0 / (point.error * point.error + between_variance);
  };
  for (const Point& point : points) {
    weights += weight(point);
    middle += weight(point) * point.x;
    level += weight(point) * point.y;
  }
  middle /= weights;
  level /= weights;
  double spread = 0.0;
  double slope = 0.0;
  if (with_slope) {
    for (const Point& point : points) {
      spread += weight(point) * (point.x - middle) * (point.x - middle);
      slope += weight(point) * (point.x - middle) * (point.y - level);
    }
    slope /= spread;
  }
  Solution solution;
  solution.middle = middle;
  solution.at_middle = level;
  solution.middle_variance = 1.0 / weights;
  solution.value << level - slope * middle, slope;
  solution.covariance(0, 0) = 1.0 / weights;
  if (with_slope) {
    solution.covariance(0, 0) += middle * middle / spread;
    solution.covariance(0, 1) = solution.covariance(1, 0) = -middle / spread;
    solution.covariance(1, 1) = 1.0 / spread;
  }
  for (const Point& point : points) {
    const double residual = point.y - level - slope * (point.x - middle);
    solution.left.squares += residual * residual;
    solution.left.chi_squared += weight(point) * residual * residual;
  }
  return solution;
}

/// But for roundings.
bool one_place(std::span<const Point> points) {
  constexpr double kRounding = 1e-9;
  const double first = points.front().x;
  return std::all_of(points.begin(), points.end(), [first](const Point& point) {
    return std::abs(point.x - first) <= kRounding * std::max(std::abs(point.x), std::abs(first));
  });
}

}  // namespace

double two_sided_t(double freedom, double outside) {
  return boost::math::quantile(boost::math::complement(boost::math::students_t{freedom}, 0.5 * outside));
}

// χ²(τ²) falls, and is below its degrees of freedom at the variance of the unweighted residuals.
double between_variance_of(const std::function<Leftover(double)>& fit, double freedom) {
  const auto excess = [&](double variance) { return fit(variance).chi_squared - freedom; };
  if (!(excess(0.0) > 0.0)) return 0.0;
  double high = fit(0.0).squares / freedom;
  if (!(high > 0.0)) return 0.0;
  if (!(excess(high) < 0.0)) return high;
  constexpr int kBits = 40;
  std::uintmax_t most_steps = 200;
  const auto [below, above] = boost::math::tools::toms748_solve(
      excess, 0.0, high, boost::math::tools::eps_tolerance<double>{kBits}, most_steps);
  return 0.5 * (below + above);
}

double student_factor(double freedom) {
  constexpr double kOutside = 0.05;
  return 0.5 * two_sided_t(freedom, kOutside);
}

Line::Prediction Line::predicted(double x) const noexcept {
  // About the middle: level and slope are independent there, and nothing cancels.
  const double off = x - middle;
  const double rise = slope ? slope->value : 0.0;
  return {at_middle + rise * off, middle_variance + off * off * covariance(1, 1)};
}

double Line::log_density(const Point& point) const {
  const Prediction here = predicted(point.x);
  const double sd = std::sqrt(here.variance + between_variance + point.error * point.error);
  const double density = boost::math::pdf(boost::math::students_t{freedom}, (point.y - here.value) / sd);
  return std::log(std::max(density, std::numeric_limits<double>::min())) - std::log(sd);
}

std::optional<Line> fit_line(std::span<const Point> points, bool with_slope) {
  const std::size_t parameters = with_slope ? 2 : 1;
  if (points.size() <= parameters || (with_slope && one_place(points))) return std::nullopt;
  Line line;
  line.freedom = static_cast<double>(points.size() - parameters);
  line.between_variance = between_variance_of(
      [&](double variance) { return solve(points, with_slope, variance).left; }, line.freedom);
  const Solution found = solve(points, with_slope, line.between_variance);
  line.covariance = found.covariance;
  line.middle = found.middle;
  line.at_middle = found.at_middle;
  line.middle_variance = found.middle_variance;
  std::vector<Point> moved{points.begin(), points.end()};
  for (Point& point : moved) point.y += point.systematic;
  const Solution other = solve(moved, with_slope, line.between_variance);
  const double widened = student_factor(line.freedom);
  const auto parameter = [&](Eigen::Index i) {
    return Parameter{found.value[i], widened * std::sqrt(found.covariance(i, i)),
                     std::abs(other.value[i] - found.value[i])};
  };
  line.level = parameter(0);
  if (with_slope) line.slope = parameter(1);
  return line;
}

double slope_error(std::span<const Point> points, double between_variance) {
  if (points.size() < 2 || one_place(points)) return std::numeric_limits<double>::infinity();
  return std::sqrt(solve(points, true, between_variance).covariance(1, 1));
}

}  // namespace stickslip::law
