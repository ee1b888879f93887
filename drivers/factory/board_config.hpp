/// \file
/// Which board, and what each driver needs to know.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "drivers/comedi/comedi_board.hpp"

namespace stickslip::drivers {

enum class Driver { kSimulated, kReplay, kComedi };

/// Scenes played one after the other, each `repeats` times.
struct SimulatedConfig {
  std::vector<std::filesystem::path> scenes;
  std::int64_t repeats = 1;
};

struct BoardConfig {
  Driver driver = Driver::kSimulated;
  double scan_rate_Hz = 350.0;  ///< Asked of the board [Penner 1995]; a replay has its own.
  SimulatedConfig simulated;
  std::filesystem::path replay_file;
  ComediBoardSettings comedi;  ///< Its scan rate is the one above.
};

}  // namespace stickslip::drivers
