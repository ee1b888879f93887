/// \file
/// The scans of one weight on the load cell: those in which it comes to rest are left out, the next are the
/// reading. The same for `stickslip calibrate` and for the daemon.
#pragma once

#include <cstddef>
#include <vector>

#include "core/daq/calibration.hpp"
#include "core/daq/weighed_calibration.hpp"

namespace stickslip::daq {

/// How long a weight is left to come to rest, and is read after that.
struct WeighingTimes {
  double settle_s = 1.0;
  double reading_s = 2.0;

  bool operator==(const WeighingTimes&) const = default;
};

inline constexpr double kHeaviestWeight_kg = 1e4;

class WeightScans {
 public:
  /// \param times  not negative. At least daq::kReadingParts scans are read.
  WeightScans(const daq::BoardInfo& board, const WeighingTimes& times);

  /// Of consecutive scans; of no use once full().
  void add(double raw);
  [[nodiscard]] bool full() const noexcept { return voltages_V_.size() >= wanted_; }
  [[nodiscard]] std::size_t count() const noexcept { return voltages_V_.size(); }
  [[nodiscard]] std::size_t wanted() const noexcept { return wanted_; }
  /// Only when full (contract).
  [[nodiscard]] daq::WeightReading reading(double mass_kg) const;

 private:
  daq::Calibration volts_;
  std::size_t to_settle_;
  std::size_t wanted_;
  std::vector<double> voltages_V_;
  bool saturated_ = false;
};

}  // namespace stickslip::daq
