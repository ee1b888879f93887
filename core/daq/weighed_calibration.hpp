/// \file
/// Calibration of a load cell by hung weights: accepts or refuses each reading, and fits the accepted ones.
///
///     const WeighedCalibration result = weigh(readings, 9.80665, 20.0);
///     if (!result.fit.load_cell) complain(result.fit.reason);
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/finding.hpp"
#include "core/daq/load_cell_fit.hpp"

namespace stickslip::daq {

/// Reading under one weight. An absent standard error or wander counts as 0 in weigh().
struct WeightReading {
  double mass_kg = 0.0;                    ///< 0: no weight (the tare).
  double voltage_V = 0.0;                  ///< Mean.
  std::optional<double> standard_error_V;  ///< Of voltage_V.
  std::optional<double> wander_V;          ///< Change of the voltage during the reading, ≥ 0.
  bool saturated = false;
};

/// Reading from scans. They are divided into kReadingParts parts; the scatter of the parts' means gives the
/// standard error, and their range the wander, which shows a swinging or creeping weight.
/// \param voltages_V  consecutive scans; at least kReadingParts of them (contract).
/// \param saturated   any of them at a rail of the converter.
[[nodiscard]] WeightReading reading_of(double mass_kg, std::span<const double> voltages_V, bool saturated);
inline constexpr std::size_t kReadingParts = 10;

/// A reading with the decision about it.
struct WeighedPoint {
  WeightReading reading;
  double force_N = 0.0;
  double residual_V = 0.0;  ///< Voltage less that of the line; NaN if there is no load cell.
  std::string refused;      ///< Why it is refused; empty if accepted, or if the first reading has a mass.
};

/// Result of weigh().
struct WeighedCalibration {
  /// Fit of the accepted readings. If weigh() finds a fault it has no load cell, but its standard errors,
  /// residual and hysteresis may be set.
  LoadCellFit fit;
  std::vector<WeighedPoint> points;  ///< In the order of the readings.
  /// Standard deviation about the line, and hysteresis, above 0.2 % of the largest difference of an
  /// unsaturated reading from the tare; none without a load cell.
  std::vector<base::Finding> findings;
};

/// Largest accepted wander of a reading, relative to its difference from the tare; of a reading without
/// weight, relative to the largest difference from the tare, or to the converter's span while there is none;
/// no limit if neither is known.
inline constexpr double kLargestWander = 0.005;
/// Smallest accepted difference of a weight from the tare, relative to the converter's span; below it, 1 % of
/// the difference would be less than 1/10 000 of the span.
inline constexpr double kSmallestChange = 0.01;
/// Fewest different weights under rising load, and fewest readings under falling load.
inline constexpr int kFewestWeights = 3;

/// Judges each reading and fits the accepted ones. Refused is a reading that is saturated, not finite or
/// unstable (kLargestWander), and a weight that changes the voltage by less than kSmallestChange or within
/// the noise. The first reading must be the tare; weights then grow, and fall again. The result has no load
/// cell but a reason, fit.reason, if there is no reading, if the first has a mass or is refused, if fewer
/// than kFewestWeights count on the way up or down, or if fit_load_cell() finds none.
/// \param readings  masses at least 0 and finite (contract).
/// \param span_V  of the converter's range; 0 if unknown: the largest difference from the tare replaces it.
[[nodiscard]] WeighedCalibration weigh(std::span<const WeightReading> readings, double gravity_m_per_s2,
                                       double span_V);

}  // namespace stickslip::daq
