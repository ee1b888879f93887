/// \file
/// Gain and zero of a load cell from hung weights: least squares of voltage on force, since the force has the
/// smaller error.
///
///     const LoadCellFit fit = fit_load_cell({{{0.0, 0.012}, {9.807, 2.464}, {19.61, 4.917}}});
///     if (!fit.load_cell) complain(fit.reason);
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/daq/calibration.hpp"

namespace stickslip::daq {

/// Reading under one hung weight. The order of the points is that of hanging; the hysteresis needs it.
struct LoadPoint {
  double force_N = 0.0;
  double voltage_V = 0.0;
  bool saturated = false;  ///< At a rail of the converter; ignored.
};

/// Result of fit_load_cell(). If there is no load cell, only used and reason are set.
struct LoadCellFit {
  std::optional<LoadCell> load_cell;                  ///< Nullopt: see reason.
  std::optional<double> gain_standard_error_N_per_V;  ///< From three points on.
  std::optional<double> zero_standard_error_V;        ///< From three points on.
  std::optional<double> residual_V;  ///< Standard deviation about the line, from three points on.
  /// Mean residual of the points under a lower load than the point before, minus that of those under a higher
  /// one, without saturated points; absent unless there are points of both kinds.
  std::optional<double> hysteresis_V;
  int used = 0;        ///< Number of points used.
  std::string reason;  ///< Set exactly when there is no load cell.
};

/// Least squares of the voltage on the force, without saturated points. The result has a reason instead of a
/// load cell if a value is not finite, also of a saturated point, if there are fewer than two different
/// loads, or if the voltage does not follow them: the slope is 0 or, from three points on, at most three of
/// its standard errors.
[[nodiscard]] LoadCellFit fit_load_cell(std::span<const LoadPoint> points);

}  // namespace stickslip::daq
