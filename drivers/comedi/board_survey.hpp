/// \file
/// Survey of a board: its capabilities, read from the board, and a configuration that uses it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

struct SubdeviceOffer {
  unsigned number = 0;
  std::string type;  ///< "analog input", "analog output", …
  int channel_count = 0;
  // Of analog inputs only.
  std::uint32_t maxdata = 0;
  std::vector<InputRange> ranges;       ///< Of channel 0.
  std::vector<std::string> references;  ///< As written in a configuration.
  bool can_command = false;             ///< Supports asynchronous commands: the board times the scans.
  bool soft_calibrated = false;
  std::optional<double> slowest_Hz;  ///< Of one channel; absent without commands.
  std::optional<double> fastest_Hz;
};

struct BoardOffer {
  std::string device;
  std::string problem;  ///< Why it cannot be used; empty if it can.
  std::string driver;
  std::string board;
  BoardPlace place;
  std::vector<SubdeviceOffer> subdevices;
  std::string configuration;  ///< The tables of a configuration that take its first analog input; TOML.

  [[nodiscard]] bool usable() const noexcept { return problem.empty(); }
};

/// Opens the board; acquires nothing and disturbs no other program.
[[nodiscard]] BoardOffer survey_board(const std::string& device, ComediCalls& calls);

}  // namespace stickslip::drivers
