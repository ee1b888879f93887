/// \file
/// Configuration of the board: kind of driver, and settings of each.
#pragma once

#include <filesystem>

#include "drivers/comedi/comedi_board.hpp"
#include "drivers/simulated/simulated_board.hpp"

namespace stickslip::drivers {

enum class Driver { kSimulated, kReplay, kComedi };

struct BoardConfig {
  Driver driver = Driver::kSimulated;
  SimulatedBoardSettings simulated;
  std::filesystem::path replay_file;
  ComediBoardSettings comedi;
};

}  // namespace stickslip::drivers
