/// \file
/// A straight line through values that have errors of their own and scatter from test to test beyond them.
///
///     const std::optional<Line> line = fit_line(points, true);
///     line->slope.error;                     // twice it covers 95 %, however few the points
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
  double systematic = 0.0;  ///< By how much it moves where all points move together.
};

struct Parameter {
  double value = 0.0;
  double error = 0.0;       ///< Half of the half width of the 95 % interval by Student's t.
  double systematic = 0.0;  ///< What it moves by if all points are moved by their systematic part.
};

struct Line {
  Parameter level;                  ///< At x = 0.
  std::optional<Parameter> slope;   ///< Absent: a constant.
  double between_variance = 0.0;    ///< Between tests, beyond their own errors.
  double freedom = 0.0;             ///< Points less parameters, ≥ 1.
  Eigen::Matrix2d covariance = {};  ///< Of level and slope, before Student's factor.
  double middle = 0.0;              ///< Weighted mean of the places: value and slope are independent there.
  double at_middle = 0.0;           ///< The line there.
  double middle_variance = 0.0;     ///< Of at_middle, before Student's factor.

  struct Prediction {
    double value = 0.0;
    double variance = 0.0;
  };
  [[nodiscard]] Prediction predicted(double x) const noexcept;
  /// Log density of Student's t for a new point, with its own error and the variance between tests.
  [[nodiscard]] double log_density(const Point& point) const;
};

/// Quantile of Student's t that leaves this probability outside on both sides together.
[[nodiscard]] double two_sided_t(double freedom, double outside);

/// By which a standard error is multiplied to be half of the half width of the 95 % interval.
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
/// \param freedom  degrees of freedom.
[[nodiscard]] double between_variance_of(const std::function<Leftover(double)>& fit, double freedom);

/// Weighted least squares with weights 1/(error² + τ²), τ² by between_variance_of(); errors of the parameters
/// by Student's t [Knapp and Hartung, Stat. Med. 22:2693–2710, 2003].
/// \return nullopt if there are no more points than parameters, or one place alone for a slope.
[[nodiscard]] std::optional<Line> fit_line(std::span<const Point> points, bool with_slope);

/// Information of the design alone: standard error of the slope with these points and this τ², before
/// Student's factor; infinite if it cannot be told.
[[nodiscard]] double slope_error(std::span<const Point> points, double between_variance);

}  // namespace stickslip::law
