/// \file
/// A board without commands: read one scan at a time, when this computer's clock says so.
#pragma once

#include <memory>

#include "core/daq/board.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_setup.hpp"

namespace stickslip::drivers {

/// Each reading is as late as the thread wakes up, so the scans jitter by that. A scan whose time went by
/// unread is a jump of the index, counted. \param clock  outlives the board.
[[nodiscard]] std::unique_ptr<daq::Board> make_polled_board(ComediSetup setup,
                                                            const ComediBoardSettings& settings,
                                                            base::Clock& clock,
                                                            std::unique_ptr<ComediCalls> calls);

}  // namespace stickslip::drivers
