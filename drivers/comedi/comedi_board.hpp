/// \file
/// An A/D board under Linux Comedi as a daq::Board.
///
///     ComediBoardSettings settings;
///     settings.device = "/dev/comedi0";
///     auto board = make_comedi_board(settings, *clock);
///     if (!board) return tl::unexpected(board.error());
///
/// Properties of Comedi that shape this code are named where they are used. The kernel gives scans no
/// time stamp: after a restart the clock tells how many scans went by.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/rate_meter.hpp"
#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

/// Where the polynomial from codes to volts comes from.
enum class CalibrationSource {
  kByFlag,  ///< Soft if the board's flag says so, else hard, else none.
  kSoft,    ///< The board's calibration file.
  kHard,    ///< As the range is reported.
  kNone,    ///< The range, spread over the codes evenly.
};

/// Source of the scan timing.
enum class AcquisitionMode {
  kByFlag,   ///< The board where it can, else this computer.
  kCommand,  ///< The board, by an asynchronous command.
  kPolled,   ///< This computer, one reading at a time: worse by its wake-up latency.
};

/// The second input of each scan, and its sensor: quantity = (voltage − zero) · gain.
struct SecondInputSettings {
  daq::SecondQuantity quantity = daq::SecondQuantity::kPullSpeed;
  unsigned channel = 1;
  /// As those of the force.
  double range_min_V = -10.0;
  double range_max_V = 10.0;
  double gain_per_V = 1.0;  ///< m/s or m for each volt; finite and not 0.
  double zero_V = 0.0;
};

/// Properties of the wanted board, whatever its device file is called. Empty: any.
struct BoardChoice {
  std::string board;  ///< As the board names itself.
  std::string serial;
  std::string bus_path;  ///< BoardPlace::bus_path.

  [[nodiscard]] bool empty() const noexcept { return board.empty() && serial.empty() && bus_path.empty(); }
};

/// Requested settings of a board; BoardInfo holds the granted ones.
struct ComediBoardSettings {
  std::string device = "/dev/comedi0";  ///< Not used if there is a choice.
  BoardChoice choice;
  /// The board that acquired last. Another one behind the same device file is refused.
  std::optional<daq::BoardInfo> before;
  std::optional<unsigned> subdevice;  ///< The first analog input if absent.
  unsigned channel = 0;
  std::optional<SecondInputSettings> second;
  /// Voltages that must fit; the narrowest span of the board that holds both is taken.
  double range_min_V = -10.0;
  double range_max_V = 10.0;
  AnalogReference reference = AnalogReference::kGround;
  CalibrationSource calibration = CalibrationSource::kByFlag;
  AcquisitionMode acquisition = AcquisitionMode::kByFlag;
  double scan_rate_Hz = 350.0;  ///< [Penner 1995]
  /// Largest relative difference between the rate asked and the rate granted.
  double scan_rate_tolerance = 0.01;
  /// The kernel's buffer, bytes; rounded up to pages. Comedi's default: 50 min at 350 Hz and 2 bytes.
  unsigned buffer_size = 2048U * 1024U;
  /// State of an earlier board object; the index continues from it by the clock.
  std::optional<daq::Continuation> continues;
};

/// Opens the board and negotiates its settings; acquires nothing and disturbs no other program.
/// \param clock  must outlive the board.
/// \return a usage error if the settings do not suit the board, a failure if the board cannot be used;
///         either says what to do.
[[nodiscard]] base::Result<std::unique_ptr<daq::Board>> make_comedi_board(const ComediBoardSettings& settings,
                                                                          base::Clock& clock);

/// As above, with replaced calls, for tests.
[[nodiscard]] base::Result<std::unique_ptr<daq::Board>> make_comedi_board(const ComediBoardSettings& settings,
                                                                          base::Clock& clock,
                                                                          std::unique_ptr<ComediCalls> calls);

}  // namespace stickslip::drivers
