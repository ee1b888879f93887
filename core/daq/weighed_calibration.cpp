#include "core/daq/weighed_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/contract.hpp"

namespace stickslip::daq {
namespace {

/// Critical value of Student's t with 2 (kReadingParts − 1) = 18 degrees of freedom, two-sided at 1 in 1000.
constexpr double kSignificant = 3.92;
/// Largest deviation from the line, relative to the largest difference from the tare; a load cell of class C3
/// (OIML R 60) is several times better.
constexpr double kLargestDeviation = 0.002;

/// Why a reading does not count; empty: it does.
std::string refusal(const WeightReading& reading, const WeightReading& tare, double span_V,
                    double largest_change_V) {
  if (!std::isfinite(reading.voltage_V)) return "no voltage was read";
  if (reading.saturated) return "saturated: the converter was at a rail";
  const double change_V = std::abs(reading.voltage_V - tare.voltage_V);
  // A tare is held against the weights that follow, and as long as there are none against the converter.
  double against_V = largest_change_V > 0.0 ? largest_change_V : span_V;
  if (reading.mass_kg > 0.0) against_V = change_V;
  const double allowed_V =
      against_V > 0.0 ? kLargestWander * against_V : std::numeric_limits<double>::infinity();
  const double wander_V = reading.wander_V.value_or(0.0);
  if (reading.mass_kg > 0.0) {
    const double error_V =
        std::hypot(reading.standard_error_V.value_or(0.0), tare.standard_error_V.value_or(0.0));
    if (change_V <= kSignificant * error_V) {
      return fmt::format("reads like no load: {:.6g} V, the tare {:.6g} V", reading.voltage_V,
                         tare.voltage_V);
    }
    if (change_V < kSmallestChange * span_V) {
      return fmt::format(
          "changes the voltage by {:.2g} %, less than 1 %: a heavier weight, or more amplification",
          100.0 * change_V / span_V);
    }
  }
  if (wander_V > allowed_V) {
    return fmt::format("unstable: moved by {:.3g} V while it was read, {:.3g} V allowed", wander_V,
                       allowed_V);
  }
  return {};
}

/// What the procedure lacks; empty: nothing.
std::string missing(const std::vector<WeighedPoint>& points) {
  std::set<double> up;
  int down = 0;
  const WeighedPoint* before = nullptr;
  for (const WeighedPoint& point : points) {
    if (!point.refused.empty()) continue;
    const double mass_kg = point.reading.mass_kg;
    if (before != nullptr && mass_kg > before->reading.mass_kg) up.insert(mass_kg);
    if (before != nullptr && mass_kg < before->reading.mass_kg) ++down;
    before = &point;
  }
  if (static_cast<int>(up.size()) < kFewestWeights) {
    return fmt::format("{} different weights count on the way up; at least {} are needed", up.size(),
                       kFewestWeights);
  }
  if (down < kFewestWeights) {
    return fmt::format("{} readings count on the way down; at least {} are needed", down, kFewestWeights);
  }
  return {};
}

LoadCellFit without(LoadCellFit fit, std::string reason) {
  fit.load_cell.reset();
  fit.reason = std::move(reason);
  return fit;
}

}  // namespace

WeightReading reading_of(double mass_kg, std::span<const double> voltages_V, bool saturated) {
  STICKSLIP_EXPECTS(voltages_V.size() >= kReadingParts);
  std::vector<double> parts;
  double sum_V = 0.0;
  for (std::size_t part = 0; part < kReadingParts; ++part) {
    const std::size_t begin = part * voltages_V.size() / kReadingParts;
    const std::size_t end = (part + 1) * voltages_V.size() / kReadingParts;
    double part_V = 0.0;
    for (std::size_t i = begin; i < end; ++i) part_V += voltages_V[i];
    sum_V += part_V;
    parts.push_back(part_V / static_cast<double>(end - begin));
  }
  WeightReading reading;
  reading.mass_kg = mass_kg;
  reading.voltage_V = sum_V / static_cast<double>(voltages_V.size());
  reading.saturated = saturated;
  double squares = 0.0;
  for (const double part_V : parts) squares += (part_V - reading.voltage_V) * (part_V - reading.voltage_V);
  // The parts scatter by noise and by whatever moves slower than one of them: both count.
  constexpr double kParts = static_cast<double>(kReadingParts);
  reading.standard_error_V = std::sqrt(squares / (kParts - 1.0) / kParts);
  const auto [least, most] = std::minmax_element(parts.begin(), parts.end());
  reading.wander_V = *most - *least;
  return reading;
}

WeighedCalibration weigh(std::span<const WeightReading> readings, double gravity_m_per_s2, double span_V) {
  WeighedCalibration result;
  for (const WeightReading& reading : readings) {
    STICKSLIP_EXPECTS(reading.mass_kg >= 0.0 && std::isfinite(reading.mass_kg));
    result.points.push_back(
        {reading, reading.mass_kg * gravity_m_per_s2, std::numeric_limits<double>::quiet_NaN(), {}});
  }
  if (readings.empty() || readings.front().mass_kg != 0.0) {
    result.fit.reason = "the first reading must be the tare: nothing hung";
    return result;
  }
  const WeightReading& tare = readings.front();
  double largest_change_V = 0.0;
  for (const WeightReading& reading : readings) {
    if (!reading.saturated && std::isfinite(reading.voltage_V)) {
      largest_change_V = std::max(largest_change_V, std::abs(reading.voltage_V - tare.voltage_V));
    }
  }
  if (!(span_V > 0.0)) span_V = largest_change_V;
  std::vector<LoadPoint> used;
  for (WeighedPoint& point : result.points) {
    point.refused = refusal(point.reading, tare, span_V, largest_change_V);
    if (point.refused.empty()) used.push_back({point.force_N, point.reading.voltage_V, false});
  }
  if (const std::string& why = result.points.front().refused; !why.empty()) {
    result.fit.reason = "the tare does not count: " + why;
    return result;
  }
  if (const std::string lack = missing(result.points); !lack.empty()) {
    result.fit = without(fit_load_cell(used), lack);
    return result;
  }
  result.fit = fit_load_cell(used);
  if (!result.fit.load_cell) return result;
  const LoadCell& cell = *result.fit.load_cell;
  for (WeighedPoint& point : result.points) {
    point.residual_V = point.reading.voltage_V - (cell.zero_V + point.force_N / cell.gain_N_per_V);
  }
  const double deviation_V = result.fit.residual_V.value_or(0.0);
  if (deviation_V > kLargestDeviation * largest_change_V) {
    base::add(result.findings,
              base::make_finding(
                  base::FindingCode::kCalibrationLine,
                  fmt::format("the readings lie {:.2g} % off the line: a wrong weight, or friction",
                              100.0 * deviation_V / largest_change_V),
                  {{"deviation", deviation_V / largest_change_V, "1"}, {"limit", kLargestDeviation, "1"}}));
  }
  const double hysteresis_V = std::abs(result.fit.hysteresis_V.value_or(0.0));
  if (hysteresis_V > kLargestDeviation * largest_change_V) {
    base::add(result.findings,
              base::make_finding(
                  base::FindingCode::kCalibrationHysteresis,
                  fmt::format("hysteresis of {:.2g} %: the cell or its mounting gives way",
                              100.0 * hysteresis_V / largest_change_V),
                  {{"hysteresis", hysteresis_V / largest_change_V, "1"}, {"limit", kLargestDeviation, "1"}}));
  }
  return result;
}

}  // namespace stickslip::daq
