/// \file
/// Troubles of a bench, simulated: an A/D board that loses scans and one whose cable is pulled out, at
/// random.
///
///     board = drivers::with_faults(std::move(board), {.overruns_every_s = 3600.0, .seed = 7});
#pragma once

#include <cstdint>
#include <memory>

#include "core/daq/board.hpp"

namespace stickslip::drivers {

/// Times between two of a kind are exponential with these means, s of the board's time; 0: none.
struct SimulatedFaults {
  double overruns_every_s = 0.0;  ///< The board loses up to kLongestOverrun_s of scans and halts.
  double losses_every_s = 0.0;    ///< The board is gone; a new one is found at once.
  std::uint64_t seed = 1;
};

/// Scans that an overrun loses are uniform from one to those of so long.
inline constexpr double kLongestOverrun_s = 5.0;

/// The same board with the faults put on it. Which scans they hit follows from the seed and from the index of
/// the first scan.
[[nodiscard]] std::unique_ptr<daq::Board> with_faults(std::unique_ptr<daq::Board> board,
                                                      const SimulatedFaults& faults);

}  // namespace stickslip::drivers
