#include "core/daq/calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace stickslip::daq {

Calibration::Calibration(const BoardInfo& board, LoadCell load_cell, double normal_load_N)
    : quantity_(board.quantity),
      maxdata_(static_cast<double>(board.maxdata)),
      polynomial_(board.polynomial),
      expansion_origin_(board.expansion_origin),
      load_cell_(load_cell),
      normal_load_N_(normal_load_N) {
  if (!(normal_load_N > 0.0) || !std::isfinite(normal_load_N)) {
    throw std::invalid_argument(fmt::format("normal load {} N must be positive", normal_load_N));
  }
  if (load_cell.gain_N_per_V == 0.0 || !std::isfinite(load_cell.gain_N_per_V) ||
      !std::isfinite(load_cell.zero_V)) {
    throw std::invalid_argument(
        fmt::format("load cell gain {} N/V must be finite and not zero, zero {} V finite",
                    load_cell.gain_N_per_V, load_cell.zero_V));
  }
  if (quantity_ == RawQuantity::kCounts) {
    const double middle = std::floor(maxdata_ / 2.0);
    step_coefficient_ = std::abs(coefficient(middle + 1.0) - coefficient(middle));
  }
}

double Calibration::volts(double raw) const noexcept {
  if (quantity_ != RawQuantity::kCounts) return raw;
  const double x = raw - expansion_origin_;
  double sum = 0.0;
  for (auto power = polynomial_.rbegin(); power != polynomial_.rend(); ++power) sum = sum * x + *power;
  return sum;
}

double Calibration::force_N(double raw) const noexcept {
  switch (quantity_) {
    case RawQuantity::kForce_N:
      return raw;
    case RawQuantity::kCoefficient:
      return raw * normal_load_N_;
    case RawQuantity::kCounts:
    case RawQuantity::kVolts:
      break;
  }
  return (volts(raw) - load_cell_.zero_V) * load_cell_.gain_N_per_V;
}

double Calibration::coefficient(double raw) const noexcept {
  // An imported coefficient is the truth: no round trip through newtons.
  return quantity_ == RawQuantity::kCoefficient ? raw : force_N(raw) / normal_load_N_;
}

}  // namespace stickslip::daq
