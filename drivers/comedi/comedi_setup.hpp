/// \file
/// What a board grants: the checks and the bargaining before the first scan.
#pragma once

#include <string>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

/// Everything that is fixed once a board has been asked.
struct ComediSetup {
  daq::BoardInfo info;
  ComediCommand command;  ///< As the board takes it, unchanged.
  std::size_t sample_size = 2;
};

/// Opens the board and agrees on a command. Does not touch the hardware.
[[nodiscard]] base::Result<ComediSetup> agree_with_board(const ComediBoardSettings& settings,
                                                         ComediCalls& calls);

/// One line for a person: what `error` (errno, > 0) means for this device and what to do.
[[nodiscard]] std::string explain_comedi_error(const std::string& device, int error);

}  // namespace stickslip::drivers
