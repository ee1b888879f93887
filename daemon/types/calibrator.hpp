/// \file
/// Interface between the control interface and the calibration of the load cell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "io/calibration_file.hpp"

#include "core/daq/calibration.hpp"
#include "core/daq/gain_change.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "core/daq/weight_scans.hpp"
#include "core/record/record.hpp"

namespace stickslip::daemon {

/// A calibration that is under way.
struct CalibrationSession {
  std::string who;  ///< Controller that began it.
  daq::WeighingTimes times;
  /// Mass of the weight that is being read; absent: none.
  std::optional<double> being_read_kg;
  daq::WeighedCalibration weighed;  ///< Fit of the readings so far.
  /// Change of the gain by that fit that finish() does only if it is confirmed.
  std::optional<daq::GainChange> gain_change;
};

/// Why a step was not done. An empty text: it was done.
struct CalibrationRefusal {
  CalibrationRefusal() = default;
  CalibrationRefusal(std::string text) : why(std::move(text)) {}  // NOLINT: a text is a refusal.
  CalibrationRefusal(const char* text) : why(text) {}             // NOLINT: as above.

  std::string why;
  std::optional<daq::GainChange> gain_change;  ///< The change that finish() wants confirmed.
};

struct CalibrationView {
  // The calibration in use.
  daq::LoadCell load_cell;
  record::CalibrationFacts facts;  ///< Empty if the configuration gave gain and zero.
  bool expired = false;

  std::string folder;  ///< Where a new calibration will be stored; empty: nowhere.
  std::string file;    ///< The calibration that this daemon stored last; empty: none.
  std::optional<CalibrationSession> session;
};

/// Main thread. Each request yields a text: why it was refused, or empty if it was done.
class Calibrator {
 public:
  virtual ~Calibrator() = default;
  /// Called once on the main thread, at once or later. \param refusal  empty: done.
  using Answer = std::function<void(CalibrationRefusal refusal)>;

  [[nodiscard]] virtual CalibrationView view() const = 0;
  /// Begins a calibration; the bench must be idle. Tests and tares are refused until finish() or give_up().
  virtual void begin(const std::string& who, const daq::WeighingTimes& times, Answer answer) = 0;
  /// Reads the weight that hangs on the cell now. The first reading is the tare, with mass 0. \param mass_kg
  /// 0 to kHeaviestWeight_kg.
  virtual void weigh(double mass_kg, Answer answer) = 0;
  /// Removes the latest reading. \return why not; empty: done.
  [[nodiscard]] virtual std::string undo() = 0;
  /// Stores the calibration in a new file and uses it from now on. A gain far from the one in use
  /// (daq::GainChange) is refused unless the paper confirms it; the readings stay.
  virtual void finish(const std::string& who, const io::CalibrationPaper& paper, Answer answer) = 0;
  /// Ends the calibration without a result. \return why not; empty: done.
  [[nodiscard]] virtual std::string give_up() = 0;
};

}  // namespace stickslip::daemon
