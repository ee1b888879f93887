/// \file
/// Collects the scans of one hung weight: skips those of the settling time, then records those of the
/// reading. Used by `stickslip calibrate` and by the daemon.
#pragma once

#include <cstddef>
#include <vector>

#include "core/daq/calibration.hpp"
#include "core/daq/weighed_calibration.hpp"

namespace stickslip::daq {

/// Settling time and reading time of a weight.
struct WeighingTimes {
  double settle_s = 1.0;
  double reading_s = 2.0;

  bool operator==(const WeighingTimes&) const = default;
};

/// Largest accepted mass of a weight, kg.
inline constexpr double kHeaviestWeight_kg = 1e4;

class WeightScans {
 public:
  /// \param times  not negative. At least daq::kReadingParts scans are read.
  WeightScans(const daq::BoardInfo& board, const WeighingTimes& times);

  /// Adds the next scan. Not needed once full().
  void add(double raw);
  [[nodiscard]] bool full() const noexcept { return voltages_V_.size() >= wanted_; }
  [[nodiscard]] std::size_t count() const noexcept { return voltages_V_.size(); }
  [[nodiscard]] std::size_t wanted() const noexcept { return wanted_; }
  /// Reading of the collected scans. Only when full() (contract).
  [[nodiscard]] daq::WeightReading reading(double mass_kg) const;

 private:
  daq::Calibration volts_;
  std::size_t to_settle_;
  std::size_t wanted_;
  std::vector<double> voltages_V_;
  bool saturated_ = false;
};

}  // namespace stickslip::daq
