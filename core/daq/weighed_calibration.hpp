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

/// Reading under one weight.
struct WeightReading {
  double mass_kg = 0.0;  ///< 0: no weight (the tare).
  double voltage_V = 0.0;
  std::optional<double> standard_error_V;  ///< Of the mean.
  std::optional<double> wander_V;          ///< Change of the voltage during the reading.
  bool saturated = false;
};

/// Reading from scans. The means of its kReadingParts parts show a swinging or creeping weight.
/// \param voltages_V  consecutive scans; at least kReadingParts of them (contract).
/// \param saturated   any of them at a rail of the converter.
[[nodiscard]] WeightReading reading_of(double mass_kg, std::span<const double> voltages_V, bool saturated);
inline constexpr std::size_t kReadingParts = 10;

/// A reading with the decision about it.
struct WeighedPoint {
  WeightReading reading;
  double force_N = 0.0;
  double residual_V = 0.0;  ///< Deviation from the line; NaN without a line.
  std::string refused;      ///< Reason why it is refused; empty if accepted.
};

struct WeighedCalibration {
  LoadCellFit fit;  ///< Fit of the accepted readings; its reason also names a breach of the procedure.
  std::vector<WeighedPoint> points;     ///< In the order of the readings.
  std::vector<base::Finding> findings;  ///< About a valid calibration.
};

/// Largest change during a reading, relative to its difference from the tare: a tenth of 5 % of S − K =
/// 0.025.
inline constexpr double kLargestWander = 0.005;
/// Smallest difference from the tare, relative to the converter's span; below it, 1 % of a reading would be
/// less than one code in 10 000.
inline constexpr double kSmallestChange = 0.01;
/// Fewest different weights under rising load, and fewest readings under falling load.
inline constexpr int kFewestWeights = 3;

/// The first reading is the tare; weights then grow, and fall again. Masses at least 0 and finite (contract).
/// \param span_V  of the converter's range; 0 if unknown, then the largest difference from the tare replaces
///        it.
[[nodiscard]] WeighedCalibration weigh(std::span<const WeightReading> readings, double gravity_m_per_s2,
                                       double span_V);

}  // namespace stickslip::daq
