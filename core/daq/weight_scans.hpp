/// \file
/// Collects the scans of one hung weight: skips those of the settling time, then records those of the
/// reading. Used by `stickslip calibrate` and by the daemon.
#pragma once

#include <cstddef>
#include <vector>

#include "core/daq/calibration.hpp"
#include "core/daq/weighed_calibration.hpp"

namespace stickslip::daq {

/// Times for one weight: first scans are skipped for settle_s, then recorded for reading_s.
struct WeighingTimes {
  double settle_s = 1.0;
  double reading_s = 2.0;

  bool operator==(const WeighingTimes&) const = default;
};

/// Largest mass of a weight that `stickslip calibrate` and the daemon accept, kg. Not checked here.
inline constexpr double kHeaviestWeight_kg = 1e4;

/// Scans of one weight, for one reading.
class WeightScans {
 public:
  /// \param board  gives counts or volts.
  /// \param times  not negative (contract), finite. At least daq::kReadingParts scans are recorded, however
  /// short reading_s is.
  WeightScans(const daq::BoardInfo& board, const WeighingTimes& times);

  /// Adds the next scan; it is skipped during the settling time. Once full(), further scans are not needed,
  /// but count in the reading.
  void add(double raw);
  [[nodiscard]] bool full() const noexcept { return voltages_V_.size() >= wanted_; }
  /// Number of scans recorded, without those skipped.
  [[nodiscard]] std::size_t count() const noexcept { return voltages_V_.size(); }
  /// Number of recorded scans from which full() is true.
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
