/// \file
/// A board of the kind that comedi_test is, without a kernel: the calls answer as the real ones were
/// seen to answer on Debian 12's kernel 6.1, odd moments included.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/comedi/comedi_calls.hpp"
#include "tests/support/manual_clock.hpp"

namespace stickslip::test {

/// A board among several; all measure alike.
struct FakeBoard {
  std::string name = "fake-board";
  drivers::BoardPlace place;
  int open_error = 0;  ///< errno of comedi_open().
};

/// What the world does to the board. Shared by the test and the calls that the board under test owns;
/// change it at any moment.
struct FakeComediWorld {
  // The board.
  unsigned flags = drivers::subdevice_flag::kCanCommand | drivers::subdevice_flag::kReadable |
                   drivers::subdevice_flag::kGround;
  bool has_hard_calibration = true;
  std::vector<drivers::InputRange> ranges{{-10.0, 10.0, true}, {-5.0, 5.0, true}};
  std::uint32_t maxdata = 65535;
  unsigned rounding_ns = 1000;  ///< Periods are rounded to this.
  unsigned shortest_period_ns = 1000;
  bool has_scan_timer = true;
  bool has_convert_now = true;
  bool takes_wake_end_of_scan = true;
  std::optional<drivers::ConversionPolynomial> soft_calibration;
  std::string serial;
  std::string bus_path;

  /// By device file; empty: one board, which answers to any.
  std::map<std::string, FakeBoard> boards;

  // What happens.
  int open_error = 0;            ///< errno of comedi_open().
  bool used_by_another = false;  ///< Another program acquires.
  bool removed = false;          ///< Unplugged.
  bool cancelled_by_another = false;
  bool locked_by_another = false;       ///< Another program holds comedi_lock() on the subdevice.
  std::int64_t removed_at_scan = -1;    ///< Unplugged when it takes this one, counted from the command.
  std::int64_t overrun_at_scan = -1;    ///< Halts at this one, once, as if the reader had slept …
  std::chrono::nanoseconds halt{0};     ///< … and is asked again so much later.
  std::int64_t suspended_at_scan = -1;  ///< The computer is suspended when the board takes this one, once …
  std::chrono::nanoseconds suspended{0};  ///< … for so long.
  std::int64_t ends_after_scans = -1;     ///< The command ends by itself, as with a stop count.
  double clock_error = 0.0;               ///< Its periods are longer by this part than it says.
  int largest_read = 1 << 20;             ///< Bytes that one read() hands over at most.
  std::chrono::nanoseconds wake_interval{std::chrono::milliseconds(8)};  ///< Of the driver's timer.

  // What was asked of it.
  std::vector<drivers::ComediCommand> tested;
  int command_count = 0;
  unsigned buffer_size = 0;
  std::chrono::milliseconds longest_poll{0};

  /// What is measured at scan `i` since the command, a code; empty: see reading().
  std::function<std::uint32_t(std::int64_t)> signal;
  std::function<std::uint32_t(std::int64_t)> second_signal;  ///< The same of second_reading().

  /// The second channel of scan `i` since the command; repeats after 65521.
  [[nodiscard]] std::uint32_t second_reading(std::int64_t i) const {
    if (second_signal) return second_signal(i);
    return static_cast<std::uint32_t>(i * 31 % (static_cast<std::int64_t>(maxdata) - 14));
  }

  /// Reading number `i` since the command: covers all codes but the rails, repeats only after 65533.
  [[nodiscard]] std::uint32_t reading(std::int64_t i) const {
    if (signal) return signal(i);
    return 1U + static_cast<std::uint32_t>((i * 7919) % (static_cast<std::int64_t>(maxdata) - 1));
  }
};

/// Real-time safe where the real one is.
class FakeComedi final : public drivers::ComediCalls {
 public:
  /// CMDF_PRIORITY.
  static constexpr unsigned kPriority = 0x8;

  /// Both must outlive it. poll() moves the clock.
  FakeComedi(FakeComediWorld& world, ManualClock& clock) : world_(world), clock_(clock) {}

  int open(const std::string& device) override;
  void close() noexcept override { running_ = false; }
  std::vector<std::string> devices() override;
  drivers::BoardPlace place(const std::string& device) override;
  std::string driver_name() override { return "fake"; }
  std::string board_name() override { return board_.name; }
  int subdevice_count() override { return 2; }
  int subdevice_type(unsigned subdevice) override { return subdevice == 0 ? drivers::kAnalogInput : 2; }
  int read_one(const drivers::ComediCommand& input, std::uint32_t& code) noexcept override;
  int find_analog_input() override { return world_.removed ? -ENODEV : 0; }
  int channel_count(unsigned subdevice) override;
  unsigned subdevice_flags(unsigned subdevice) override { return subdevice == 0 ? world_.flags : 0U; }
  std::uint32_t maxdata(unsigned subdevice, unsigned channel) override;
  int range_count(unsigned subdevice, unsigned channel) override;
  std::optional<drivers::InputRange> range(unsigned subdevice, unsigned channel, unsigned range) override;
  std::optional<drivers::ConversionPolynomial> hard_calibration(unsigned subdevice, unsigned channel,
                                                                unsigned range) override;
  base::Result<drivers::ConversionPolynomial> soft_calibration(unsigned subdevice, unsigned channel,
                                                               unsigned range) override;
  int command_test(drivers::ComediCommand& command) override;
  int command(const drivers::ComediCommand& command) override;
  int cancel(unsigned subdevice) noexcept override;
  int set_buffer_size(unsigned subdevice, unsigned size) override;
  int poll(std::chrono::milliseconds timeout) noexcept override;
  int read(std::span<std::byte> buffer) noexcept override;

 private:
  static constexpr int kChannelCount = 8;

  [[nodiscard]] int stage_of(drivers::ComediCommand& command) const;
  [[nodiscard]] std::int64_t sample_size() const;
  [[nodiscard]] std::int64_t scan_size() const;
  [[nodiscard]] std::int64_t period_ns() const;
  /// The driver's timer as of now: scans taken since the command, stopped by an overrun.
  void run_board() noexcept;

  FakeComediWorld& world_;
  ManualClock& clock_;
  FakeBoard board_;  ///< The one that is open.
  drivers::ComediCommand command_;
  bool running_ = false;  ///< The subdevice is busy with a command of ours.
  bool ended_ = false;    ///< As many scans as it was to take.
  bool overrun_ = false;  ///< It halted; what is stored can still be read.
  std::int64_t began_ns_ = 0;
  std::int64_t taken_bytes_ = 0;  ///< Since the command.
  std::int64_t read_bytes_ = 0;
  std::int64_t insn_count_ = 0;
  std::optional<unsigned> first_channel_;  ///< Of the readings one at a time.
};

}  // namespace stickslip::test
