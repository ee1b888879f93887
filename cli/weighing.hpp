/// \file
/// Readings of a load cell for its calibration, from whatever board the configuration names.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "core/daq/weight_scans.hpp"
#include "drivers/factory/factory.hpp"

namespace stickslip::cli {

/// What a configuration says to somebody who calibrates: it need not know the load cell yet.
struct WeighingPlace {
  drivers::BoardConfig board;
  double clock_speed = 1.0;
  double gravity_m_per_s2 = 0.0;
  std::filesystem::path folder;                  ///< [tester] calibration; empty: not said.
  std::optional<double> load_cell_gain_N_per_V;  ///< [tester] load_cell_gain.
};

/// Errors: kUsage as load_config().
[[nodiscard]] base::Result<WeighingPlace> load_weighing_place(const std::filesystem::path& config);

/// Owns the board; it acquires only while a weight is read, so that what was before is not counted.
class Weighing {
 public:
  /// Errors: those of the board; kUsage if its source gives neither counts nor volts.
  [[nodiscard]] static base::Result<Weighing> open(const WeighingPlace& place);

  [[nodiscard]] const daq::BoardInfo& board() const { return board_.board->info(); }
  /// Of the converter; 0 if unknown.
  [[nodiscard]] double span_V() const;
  /// Errors: kFailure if the board gives no scans or its input ends.
  [[nodiscard]] base::Result<daq::WeightReading> read(double mass_kg, const daq::WeighingTimes& times);

 private:
  Weighing(std::unique_ptr<base::Clock> clock, drivers::OpenedBoard board);

  std::unique_ptr<base::Clock> clock_;
  drivers::OpenedBoard board_;
  std::deque<double> rest_;  ///< Scans that came with the last of a reading.
};

}  // namespace stickslip::cli
