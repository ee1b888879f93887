/// \file
/// Search for the configured board under all device files: the kernel may give a board that comes back
/// another one, and its own to another board.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

/// What tells one board from another.
struct BoardIdentity {
  std::string board;  ///< As comedi_get_board_name() tells it.
  std::string driver;
  BoardPlace place;
};

/// "das1602/16 (cb_pcidas)": the name in records and state.
[[nodiscard]] std::string full_name(const BoardIdentity& identity);

/// Opens the board that the settings choose.
/// With board, serial or bus_path in the settings: the one board to which they all apply, whatever its device
/// file. Else that behind settings.device, unless another one acquired before (settings.before).
/// \return its device file. Errors name the boards that are there instead.
[[nodiscard]] base::Result<std::string> open_chosen(const ComediBoardSettings& settings, ComediCalls& calls);

}  // namespace stickslip::drivers
