/// \file
/// A load cell calibrated by hanging known weights: which readings count, which do not and why, and what the
/// rest says.
///
///     const WeighedCalibration result = weigh(readings, 9.80665, 20.0);
///     if (!result.fit.load_cell) complain(result.fit.reason);
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/daq/load_cell_fit.hpp"

namespace stickslip::daq {

/// What was read while a weight hung still, or ought to.
struct WeightReading {
  double mass_kg = 0.0;  ///< 0: nothing hung (the tare).
  double voltage_V = 0.0;
  std::optional<double> standard_error_V;  ///< Of the mean.
  std::optional<double> wander_V;          ///< By how much it moved while it was read.
  bool saturated = false;
};

/// Means of a reading's parts, from which the weight's swinging and creeping show.
/// \param voltages_V  consecutive scans; at least kReadingParts of them (contract).
/// \param saturated   any of them at a rail of the converter.
[[nodiscard]] WeightReading reading_of(double mass_kg, std::span<const double> voltages_V, bool saturated);
inline constexpr std::size_t kReadingParts = 10;

/// A reading after judgement.
struct WeighedPoint {
  WeightReading reading;
  double force_N = 0.0;
  double residual_V = 0.0;  ///< Off the line; NaN where there is none.
  std::string refused;      ///< Why it does not count; empty: it does.
};

struct WeighedCalibration {
  LoadCellFit fit;  ///< Of the readings that count; its reason also where the procedure was not kept.
  std::vector<WeighedPoint> points;   ///< In the order of the readings.
  std::vector<std::string> findings;  ///< What somebody should look at although there is an answer.
};

/// A reading may wander by this part of its change from the tare: ten times better than 5 % of S − K = 0.025.
inline constexpr double kLargestWander = 0.005;
/// Of the converter's span: below, 1 % of a reading would be less than a code in 10 000.
inline constexpr double kSmallestChange = 0.01;
/// Different weights on the way up, and readings on the way down.
inline constexpr int kFewestWeights = 3;

/// The first reading is the tare; weights then grow, and fall again. Masses at least 0 and finite (contract).
/// \param span_V  of the converter's range; 0 if unknown: the largest change stands for it.
[[nodiscard]] WeighedCalibration weigh(std::span<const WeightReading> readings, double gravity_m_per_s2,
                                       double span_V);

}  // namespace stickslip::daq
