/// \file
/// A board without asynchronous commands, read one scan at a time, timed by this computer's clock.
#pragma once

#include <memory>

#include "core/daq/board.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_setup.hpp"

namespace stickslip::drivers {

/// The wake-up latency of the thread delays each reading, so the scans jitter. A scan that could not be read
/// in time is a gap with known count.
/// \param clock  must outlive the board.
[[nodiscard]] std::unique_ptr<daq::Board> make_polled_board(ComediSetup setup,
                                                            const ComediBoardSettings& settings,
                                                            base::Clock& clock,
                                                            std::unique_ptr<ComediCalls> calls);

}  // namespace stickslip::drivers
