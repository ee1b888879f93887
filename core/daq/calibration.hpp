/// \file
/// Conversion of a raw reading to volts, newtons and coefficient of friction. All steps are linear except the
/// board's polynomial.
///
///     Calibration calibration{board.info(), load_cell, normal_load_N};
///     double c = calibration.coefficient(block.raw[0]);
#pragma once

#include <vector>

#include "core/daq/board.hpp"

namespace stickslip::daq {

/// The load cell with its amplifier: force = (voltage − zero) · gain.
struct LoadCell {
  double gain_N_per_V = 1.0;
  double zero_V = 0.0;
};

/// Converts the raw readings of one board. Real-time safe after construction, but for copies.
class Calibration {
 public:
  /// \param normal_load_N  sled mass × g.
  /// \throws std::invalid_argument unless gain is finite and not zero, zero finite, load positive and finite.
  Calibration(const BoardInfo& board, LoadCell load_cell, double normal_load_N);

  /// Volts at the board's input; the reading itself if it is no count.
  [[nodiscard]] double volts(double raw) const noexcept;
  /// Force on the load cell, N.
  [[nodiscard]] double force_N(double raw) const noexcept;
  /// Force over the normal load.
  [[nodiscard]] double coefficient(double raw) const noexcept;

  /// Copy with another zero of the load cell, finite (not checked). Allocates.
  [[nodiscard]] Calibration with_zero(double zero_V) const {
    Calibration other = *this;
    other.load_cell_.zero_V = zero_V;
    return other;
  }
  /// Whether the raw reading is a voltage or a count, so that the load cell's gain and zero apply.
  [[nodiscard]] bool measures_voltage() const noexcept {
    return quantity_ == RawQuantity::kCounts || quantity_ == RawQuantity::kVolts;
  }
  [[nodiscard]] const LoadCell& load_cell() const noexcept { return load_cell_; }

  [[nodiscard]] double normal_load_N() const noexcept { return normal_load_N_; }
  /// One A/D step in the middle of the range as a coefficient, ≥ 0; 0 unless raw readings are counts.
  [[nodiscard]] double step_coefficient() const noexcept { return step_coefficient_; }
  /// Whether the reading is at a rail of the converter (code 0 or maxdata); the true value may then lie
  /// outside. False unless raw readings are counts.
  [[nodiscard]] bool saturated(double raw) const noexcept {
    return quantity_ == RawQuantity::kCounts && (raw <= 0.0 || raw >= maxdata_);
  }

 private:
  RawQuantity quantity_;
  double maxdata_;
  std::vector<double> polynomial_;
  double expansion_origin_;
  LoadCell load_cell_;
  double normal_load_N_;
  double step_coefficient_ = 0.0;
};

}  // namespace stickslip::daq
