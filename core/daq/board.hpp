/// \file
/// Interface of a board. Hardware, simulation and replay implement it and pass one conformance suite
/// (tests/conformance); no caller need distinguish them.
///
///     base::Result<void> started = board.start();
///     daq::ScanBlock block;
///     while (board.read(block, 100ms) == daq::ReadStatus::kScans) ring.push(block);
///     board.stop();
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/daq/scan_block.hpp"
#include "core/daq/second_channel.hpp"

namespace stickslip::daq {

/// Physical quantity of a raw reading.
enum class RawQuantity {
  kCounts,       ///< A/D code, 0 … maxdata.
  kVolts,        ///< Imported, or simulated without a converter; V.
  kForce_N,      ///< Imported, N.
  kCoefficient,  ///< Imported, force over the sled's weight.
};

/// Properties of the board in use: values that it granted, unless the name says requested.
struct BoardInfo {
  std::string driver;  ///< "comedi", "simulated", "replay"; in the record of an imported trace "import".
  /// Name reported by the board; of a Comedi board followed by its driver in parentheses.
  std::string board_name;
  std::string device;  ///< Path or scene or file; for people.
  std::string serial;  ///< Serial number; empty: none. Not recorded.
  /// Where it is plugged in: as udev's ID_PATH, or its path in sysfs; empty: unknown. Not recorded.
  std::string bus_path;
  int subdevice = 0;
  int channel = 0;
  RawQuantity quantity = RawQuantity::kCounts;
  std::uint32_t maxdata = 0;  ///< Largest code; 0 if quantity is not kCounts.
  double range_min_V = 0.0;
  double range_max_V = 0.0;
  /// raw → volts, ascending powers of (raw - expansion_origin); {0, 1} if quantity is not kCounts.
  std::vector<double> polynomial{0.0, 1.0};
  double expansion_origin = 0.0;
  double scan_rate_requested_Hz = 0.0;
  double scan_rate_granted_Hz = 0.0;
  /// Where the polynomial comes from: "soft" (the board's calibration file), "hard" (the range as the board
  /// reports it), "none" (the range, spread over the codes evenly); empty if quantity is not kCounts or
  /// unknown.
  std::string calibration;
  /// "command" (the board's own timer) or "polled" (one reading at a time, timed by this computer); empty:
  /// unknown.
  std::string acquisition;
  std::string notes;  ///< Settings that the board changed or does not have; for people. Not recorded.
  std::optional<SecondChannel> second;  ///< Second channel, read in each scan; only if quantity is kCounts.
};

/// How a read ended.
enum class ReadStatus {
  kScans,  ///< The block holds at least one scan.
  /// No scan arrived in time. Also before start(), after stop() and after a status that is reported once,
  /// until start(); but a missing board gives kBoardMissing.
  kTimeout,
  kEndOfInput,    ///< There will be no more scans (end of a replay or a simulation). Repeats until stop().
  kOverrun,       ///< The board lost scans and halted; start() again. Reported once.
  kSuspended,     ///< The computer was suspended, and scans were lost; start() again. Reported once.
  kBoardMissing,  ///< The board is gone or silent; only a new board object can bring it back. Repeats.
  kFailed,        ///< Any other error; last_error() says which. stop() and start() again. Reported once.
};

/// One analog input, and a second one if info() has one, acquiring scans at a fixed rate.
/// Thread-bound: the acquisition thread owns it between start() and stop().
class Board {
 public:
  virtual ~Board() = default;

  /// Constant during the life of the board.
  [[nodiscard]] virtual const BoardInfo& info() const noexcept = 0;

  /// Begins (or begins again) to acquire. Indices go on rising across restarts: the first scan
  /// after a restart has an index ≥ the end of the last block delivered.
  /// Calling it while acquiring is allowed and does nothing.
  [[nodiscard]] virtual base::Result<void> start() = 0;

  /// Waits at most `timeout` for scans and fills `block` with 1 … kMaxScans of them, stamped.
  /// On any status but kScans block.count is 0. Does not allocate, lock, log or throw.
  [[nodiscard]] virtual ReadStatus read(ScanBlock& block, std::chrono::milliseconds timeout) noexcept = 0;

  /// Ends the acquisition; scans not read may be lost. Allowed at any time, any number of times.
  virtual void stop() noexcept = 0;

  /// Reason for the last failure of start() or read(), for the user; empty if neither failed since a start()
  /// succeeded, or if the board gives none. kTimeout, kEndOfInput and kSuspended are no failures.
  [[nodiscard]] virtual std::string last_error() const { return {}; }
};

}  // namespace stickslip::daq
