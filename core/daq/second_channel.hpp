/// \file
/// Second channel: an input read in each scan after the force, for the pull speed or the position of the
/// sled.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::daq {

enum class SecondQuantity {
  kPullSpeed,     ///< Speed of the carriage that pulls, m/s; negative as it returns.
  kSledPosition,  ///< Position of the sled, m; constant while the sled sticks.
};

[[nodiscard]] constexpr std::string_view name(SecondQuantity quantity) noexcept {
  return quantity == SecondQuantity::kPullSpeed ? "pull_speed" : "sled_position";
}

[[nodiscard]] constexpr std::optional<SecondQuantity> second_quantity_from_name(
    std::string_view text) noexcept {
  for (const auto quantity : {SecondQuantity::kPullSpeed, SecondQuantity::kSledPosition}) {
    if (text == name(quantity)) return quantity;
  }
  return std::nullopt;
}

/// The second channel: settings granted by the board, and the sensor: quantity = (voltage − zero) · gain.
struct SecondChannel {
  SecondQuantity quantity = SecondQuantity::kPullSpeed;
  int channel = 1;
  std::uint32_t maxdata = 0;  ///< Largest code, 1 to 2³¹ − 1.
  double range_min_V = 0.0;
  double range_max_V = 0.0;
  /// code → volts, ascending powers of (code − expansion_origin).
  std::vector<double> polynomial{0.0, 1.0};
  double expansion_origin = 0.0;
  std::string calibration;  ///< As BoardInfo::calibration.
  double gain_per_V = 1.0;  ///< m/s or m for each volt; finite and not 0.
  double zero_V = 0.0;      ///< Voltage at speed 0 or position 0.

  /// Marks a missing code.
  static constexpr std::int32_t kNoCode = -1;

  /// Value of a code, m/s or m; NaN for kNoCode. Real-time safe.
  [[nodiscard]] double value(std::int32_t code) const noexcept {
    if (code < 0) return std::numeric_limits<double>::quiet_NaN();
    const double x = static_cast<double>(code) - expansion_origin;
    double volts = 0.0;
    for (std::size_t power = polynomial.size(); power > 0; --power) volts = volts * x + polynomial[power - 1];
    return (volts - zero_V) * gain_per_V;
  }
  /// One A/D step in the middle of the range, m/s or m, ≥ 0.
  [[nodiscard]] double step() const noexcept {
    const auto middle = static_cast<std::int32_t>(maxdata / 2);
    return std::abs(value(middle + 1) - value(middle));
  }

  bool operator==(const SecondChannel&) const = default;
};

}  // namespace stickslip::daq
