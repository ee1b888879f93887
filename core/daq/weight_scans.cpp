#include "core/daq/weight_scans.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"

namespace stickslip::daq {
namespace {

/// Volts are force over 1 N/V, whatever the load.
daq::Calibration volts_of(const daq::BoardInfo& board) { return {board, {1.0, 0.0}, 1.0}; }

std::size_t scans_in(double time_s, const daq::BoardInfo& board) {
  STICKSLIP_EXPECTS(time_s >= 0.0);
  return static_cast<std::size_t>(std::llround(time_s * board.scan_rate_granted_Hz));
}

}  // namespace

WeightScans::WeightScans(const daq::BoardInfo& board, const WeighingTimes& times)
    : volts_(volts_of(board)),
      to_settle_(scans_in(times.settle_s, board)),
      wanted_(std::max(daq::kReadingParts, scans_in(times.reading_s, board))) {
  voltages_V_.reserve(wanted_);
}

void WeightScans::add(double raw) {
  if (to_settle_ > 0) {
    --to_settle_;
    return;
  }
  voltages_V_.push_back(volts_.volts(raw));
  saturated_ = saturated_ || volts_.saturated(raw);
}

daq::WeightReading WeightScans::reading(double mass_kg) const {
  STICKSLIP_EXPECTS(full());
  return daq::reading_of(mass_kg, voltages_V_, saturated_);
}

}  // namespace stickslip::daq
