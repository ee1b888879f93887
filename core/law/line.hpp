/// \file
/// A straight line through values that have errors of their own and scatter from test to test beyond them.
///
///     const std::optional<Line> line = fit_line(points, true);
///     line->slope->error;                    // twice it covers 95 %, however few the points
///     line->predicted(0.3).variance;         // of the line there, without that of a new value
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include <Eigen/Core>

namespace stickslip::law {

/// A value at a place, as one test gives it.
struct Point {
  double x = 0.0;
  double y = 0.0;
  double error = 0.0;       ///< Standard error, > 0.
  double systematic = 0.0;  ///< By how much y is off where all points are off together; with its sign.
};

/// A fitted number with its errors.
struct Parameter {
  double value = 0.0;
  double error = 0.0;       ///< Half of the half width of the 95 % interval by Student's t.
  double systematic = 0.0;  ///< What it moves by if all points are moved by their systematic part; ≥ 0.
};

/// A fitted line, or a fitted constant.
struct Line {
  Parameter level;                  ///< At x = 0.
  std::optional<Parameter> slope;   ///< Absent: a constant.
  double between_variance = 0.0;    ///< Variance between tests, beyond their own errors.
  double freedom = 0.0;             ///< Points less parameters, ≥ 1.
  Eigen::Matrix2d covariance = {};  ///< Of level and slope, before Student's factor.
  double middle = 0.0;              ///< Weighted mean of the places: value and slope are independent there.
  double at_middle = 0.0;           ///< The line at `middle`.
  double middle_variance = 0.0;     ///< Of at_middle, before Student's factor.

  /// The line at a place.
  struct Prediction {
    double value = 0.0;
    double variance = 0.0;  ///< Before Student's factor; without that of a new value.
  };
  [[nodiscard]] Prediction predicted(double x) const noexcept;
  /// Log density of Student's t for a new point, with its own error and the variance between tests.
  [[nodiscard]] double log_density(const Point& point) const;
};

/// Quantile of Student's t that leaves this probability outside on both sides together.
/// \param freedom  > 0. \param outside  > 0, < 1.
[[nodiscard]] double two_sided_t(double freedom, double outside);

/// Factor that makes a standard error half of the half width of the 95 % interval. \param freedom > 0.
[[nodiscard]] double student_factor(double freedom);

/// What a fit with weights 1/(error² + τ²) leaves over.
struct Leftover {
  double chi_squared = 0.0;  ///< Weighted squares of the residuals.
  double squares = 0.0;      ///< Of the residuals, unweighted.
};

/// Variance τ² between tests for which the weighted squares of the residuals add up to `freedom`; zero if
/// they are less without it [Paule and Mandel, J. Res. NBS 87:377–385, 1982; DerSimonian and Kacker, Contemp.
/// Clin. Trials 28:105–114, 2007].
/// \param fit  gives the residuals of the fit with a τ².
/// \param freedom  degrees of freedom, > 0.
[[nodiscard]] double between_variance_of(const std::function<Leftover(double)>& fit, double freedom);

/// Weighted least squares with weights 1/(error² + τ²), τ² by between_variance_of(); errors of the parameters
/// by Student's t [Knapp and Hartung, Stat. Med. 22:2693–2710, 2003].
/// \return nullopt if there are no more points than parameters, or one place alone for a slope.
[[nodiscard]] std::optional<Line> fit_line(std::span<const Point> points, bool with_slope);

/// Standard error of the slope by the places and errors of the points and this τ², before Student's factor;
/// the values do not matter. Infinite with fewer than two points or one place.
[[nodiscard]] double slope_error(std::span<const Point> points, double between_variance);

}  // namespace stickslip::law
