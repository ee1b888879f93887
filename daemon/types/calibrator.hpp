/// \file
/// The calibration of the load cell as people ask for it through the control interface.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "io/calibration_file.hpp"

#include "core/daq/calibration.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "core/daq/weight_scans.hpp"
#include "core/record/record.hpp"

namespace stickslip::daemon {

/// One that is under way.
struct CalibrationSession {
  std::string who;  ///< Began it.
  daq::WeighingTimes times;
  std::optional<double> being_read_kg;  ///< Its scans are coming.
  daq::WeighedCalibration weighed;      ///< Of the readings so far.
};

struct CalibrationView {
  // In use.
  daq::LoadCell load_cell;
  record::CalibrationFacts facts;  ///< Empty where the configuration gave the numbers.
  bool expired = false;

  std::string folder;  ///< Where a new one will be kept; empty: nowhere.
  std::string file;    ///< The one kept last by this daemon; empty: none.
  std::optional<CalibrationSession> session;
};

/// Main thread. Each request ends in a refusal for people, empty if it was done.
class Calibrator {
 public:
  virtual ~Calibrator() = default;
  /// Called once, at once or later.
  using Answer = std::function<void(std::string refusal)>;

  [[nodiscard]] virtual CalibrationView view() const = 0;
  /// On an idle bench, which stays idle until finish() or give_up().
  virtual void begin(const std::string& who, const daq::WeighingTimes& times, Answer answer) = 0;
  /// Reads what hangs now. The first is the tare: 0. \param mass_kg  0 to kHeaviestWeight_kg.
  virtual void weigh(double mass_kg, Answer answer) = 0;
  /// Forgets the latest reading.
  [[nodiscard]] virtual std::string undo() = 0;
  /// Keeps the calibration in a file of its own and uses it from here on.
  virtual void finish(const std::string& who, const io::CalibrationPaper& paper, Answer answer) = 0;
  [[nodiscard]] virtual std::string give_up() = 0;
};

}  // namespace stickslip::daemon
