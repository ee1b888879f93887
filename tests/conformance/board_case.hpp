/// \file
/// What the conformance suite needs to know of a kind of board. Each kind has a file of its own here
/// that makes one case.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include "core/base/clock.hpp"
#include "core/daq/board.hpp"
#include "tests/support/manual_clock.hpp"

namespace stickslip::test {

/// A board and whatever it lives from, destroyed in the right order.
struct BoardRig {
  std::shared_ptr<void> world;         ///< Fake hardware, files: outlives the board.
  std::shared_ptr<base::Clock> clock;  ///< The board's, where it is not the one moved by hand.
  std::unique_ptr<daq::Board> board;
};

/// One kind of board.
struct BoardCase {
  std::string name;  ///< Letters and digits: part of the test's name.
  /// A fresh board over the same input each time.
  std::function<BoardRig(ManualClock&)> make;
  /// By how much a read may return later than asked: 0 where the clock is moved by hand.
  std::chrono::nanoseconds lateness{0};
  bool input_repeats = true;  ///< The same readings after each start of a fresh board.
};

inline void PrintTo(const BoardCase& board_case, std::ostream* out) { *out << board_case.name; }

/// No end; the fake board gives the same readings after each start.
[[nodiscard]] BoardCase comedi_case();
/// The same without commands: read one scan at a time.
[[nodiscard]] BoardCase polled_comedi_case();
/// Both with a second channel.
[[nodiscard]] BoardCase comedi_second_case();
[[nodiscard]] BoardCase polled_comedi_second_case();
/// A board of the kernel, by the system's clock: the one that the environment variable
/// STICKSLIP_COMEDI_DEVICE names, none without it. Its input repeats if STICKSLIP_COMEDI_REPEATS is set.
[[nodiscard]] std::optional<BoardCase> comedi_device_case();
/// The same with its channel 1 as a second channel; none unless STICKSLIP_COMEDI_SECOND is set.
[[nodiscard]] std::optional<BoardCase> comedi_device_second_case();
/// One repetition of the ring-down and of the stick-slip, then the end.
[[nodiscard]] BoardCase simulated_case();
/// The simulated board with a clock that is off, jitter and missing scans; two repetitions, then the end.
[[nodiscard]] BoardCase simulated_gaps_case();
/// One repetition of a ramp with the belt's speed as a second channel, then the end.
[[nodiscard]] BoardCase simulated_speed_case();
/// A ring-down whose load cell carries a weight, then the end.
[[nodiscard]] BoardCase simulated_hanging_case();
/// A record without gaps that does not begin at index 0, then the end.
[[nodiscard]] BoardCase replay_case();
/// The same with a second channel.
[[nodiscard]] BoardCase replay_second_case();

}  // namespace stickslip::test
