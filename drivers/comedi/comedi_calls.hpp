/// \file
/// Table of the libcomedi functions and file operations in use, which tests can replace
/// (tests/support/fake_comedi.hpp). Each function makes one call of libcomedi.
///
/// Every int is ≥ 0 on success and −errno on failure, also where libcomedi reports otherwise.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/comedi/board_place.hpp"

namespace stickslip::drivers {

/// Trigger sources of a command: the values of comedi.h (TRIG_…), so that a fake can speak them.
namespace trigger {
inline constexpr unsigned kNone = 0x1;
inline constexpr unsigned kNow = 0x2;
inline constexpr unsigned kFollow = 0x4;
inline constexpr unsigned kTimer = 0x10;
inline constexpr unsigned kCount = 0x20;
}  // namespace trigger

/// Bit of ComediCommand::flags: wake the reader after each scan, not at a half-full FIFO (CMDF_WAKE_EOS).
inline constexpr unsigned kWakeEndOfScan = 0x20;

/// Bits of the subdevice flags (SDF_…).
namespace subdevice_flag {
inline constexpr unsigned kCanCommand = 0x8000;       ///< SDF_CMD_READ
inline constexpr unsigned kReadable = 0x10000;        ///< SDF_READABLE
inline constexpr unsigned kSoftCalibrated = 0x2000;   ///< SDF_SOFT_CALIBRATED
inline constexpr unsigned kGround = 0x100000;         ///< SDF_GROUND
inline constexpr unsigned kCommon = 0x200000;         ///< SDF_COMMON
inline constexpr unsigned kDifferential = 0x400000;   ///< SDF_DIFF
inline constexpr unsigned kOther = 0x800000;          ///< SDF_OTHER
inline constexpr unsigned kLargeSample = 0x10000000;  ///< SDF_LSAMPL: a sample has 4 bytes, else 2
}  // namespace subdevice_flag

inline constexpr int kAnalogInput = 1;  ///< COMEDI_SUBD_AI

/// Reference potential of the input (AREF_…).
enum class AnalogReference : unsigned { kGround = 0, kCommon = 1, kDifferential = 2, kOther = 3 };

/// One entry of a channel list.
struct ComediInput {
  unsigned channel = 0;
  unsigned range = 0;

  bool operator==(const ComediInput&) const = default;
};

/// comedi_cmd for one channel or two.
struct ComediCommand {
  unsigned subdevice = 0;
  unsigned flags = 0;
  unsigned start_source = 0, start_argument = 0;
  unsigned scan_begin_source = 0, scan_begin_argument = 0;  ///< ns if the source is kTimer.
  unsigned convert_source = 0, convert_argument = 0;        ///< ns if the source is kTimer.
  unsigned scan_end_source = 0, scan_end_argument = 0;
  unsigned stop_source = 0, stop_argument = 0;
  unsigned channel = 0;
  unsigned range = 0;
  AnalogReference reference = AnalogReference::kGround;
  std::optional<ComediInput> second;  ///< Converted right after the first, with the same reference.

  [[nodiscard]] unsigned channel_count() const noexcept { return second ? 2 : 1; }
  bool operator==(const ComediCommand&) const = default;
};

/// One input span of a channel.
struct InputRange {
  double min = 0.0;
  double max = 0.0;
  bool in_volts = true;  ///< False for mA and for spans without a unit.
};

/// raw → volts: Σ coefficients[i] · (raw − expansion_origin)^i.
struct ConversionPolynomial {
  std::vector<double> coefficients;
  double expansion_origin = 0.0;
};

/// One board. Thread-bound.
class ComediCalls {
 public:
  virtual ~ComediCalls() = default;

  /// comedi_open(), then O_NONBLOCK and FD_CLOEXEC, which it does not set.
  virtual int open(const std::string& device) = 0;
  /// Closes the device and ends a running command of this process. Allowed when nothing is open.
  virtual void close() noexcept = 0;

  /// Device files of boards (not of single subdevices) that exist, in order.
  virtual std::vector<std::string> devices() = 0;
  virtual BoardPlace place(const std::string& device) = 0;

  virtual std::string driver_name() = 0;
  virtual std::string board_name() = 0;
  /// \return number of the first analog input subdevice.
  virtual int find_analog_input() = 0;
  virtual int subdevice_count() = 0;
  /// COMEDI_SUBD_…: kAnalogInput is 1.
  virtual int subdevice_type(unsigned subdevice) = 0;
  virtual int channel_count(unsigned subdevice) = 0;
  virtual unsigned subdevice_flags(unsigned subdevice) = 0;
  virtual std::uint32_t maxdata(unsigned subdevice, unsigned channel) = 0;
  virtual int range_count(unsigned subdevice, unsigned channel) = 0;
  virtual std::optional<InputRange> range(unsigned subdevice, unsigned channel, unsigned range) = 0;
  /// The polynomial of the range itself (comedi_get_hardcal_converter).
  virtual std::optional<ConversionPolynomial> hard_calibration(unsigned subdevice, unsigned channel,
                                                               unsigned range) = 0;
  /// The polynomial in the board's calibration file (comedi_get_softcal_converter).
  virtual base::Result<ConversionPolynomial> soft_calibration(unsigned subdevice, unsigned channel,
                                                              unsigned range) = 0;

  /// \return 0 if the board accepts the command unchanged; 1 … 5 is the stage that refused it, and `command`
  /// then holds the board's alternative.
  virtual int command_test(ComediCommand& command) = 0;
  virtual int command(const ComediCommand& command) = 0;
  /// Ends the command; unread scans are lost.
  virtual int cancel(unsigned subdevice) noexcept = 0;
  /// \return the size in use. The setting outlives close().
  virtual int set_buffer_size(unsigned subdevice, unsigned size) = 0;

  /// One reading of the first channel, now (comedi_data_read). Real-time safe. \return ≥ 0 and the code.
  virtual int read_one(const ComediCommand& input, std::uint32_t& code) noexcept = 0;

  /// Waits until there may be something to read.
  /// \return 0 if the time is over: also when the board was removed, which no poll() reports. Real-time safe.
  virtual int poll(std::chrono::milliseconds timeout) noexcept = 0;
  /// \return bytes, not necessarily whole samples; 0 if the command ended by itself. Real-time safe.
  virtual int read(std::span<std::byte> buffer) noexcept = 0;
};

/// As ComediCalls::devices(), in any folder.
[[nodiscard]] std::vector<std::string> comedi_devices(const std::string& folder = "/dev");

/// The real calls.
[[nodiscard]] std::unique_ptr<ComediCalls> make_comedi_calls();

}  // namespace stickslip::drivers
