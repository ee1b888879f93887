/// \file
/// Setup of a board: checks and negotiation before the first scan.
#pragma once

#include <cstddef>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

/// Settings fixed by the negotiation.
struct ComediSetup {
  daq::BoardInfo info;
  ComediCommand command;  ///< As the board takes it, unchanged.
  std::size_t sample_size = 2;
  bool polled = false;  ///< Of `command`, only subdevice, channel, range and reference count then.
};

/// Opens the board and agrees on a command. Does not touch the hardware.
[[nodiscard]] base::Result<ComediSetup> agree_with_board(const ComediBoardSettings& asked,
                                                         ComediCalls& calls);

}  // namespace stickslip::drivers
