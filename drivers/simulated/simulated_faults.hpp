/// \file
/// Simulated faults of a bench at random times: overruns of the A/D board, and loss of the board.
///
///     board = drivers::with_faults(std::move(board), {.overruns_every_s = 3600.0, .seed = 7});
#pragma once

#include <cstdint>
#include <memory>

#include "core/daq/board.hpp"

namespace stickslip::drivers {

/// Mean times between faults of a kind, s of the board's time; exponentially distributed. 0: no such fault.
struct SimulatedFaults {
  double overruns_every_s = 0.0;  ///< The board loses up to kLongestOverrun_s of scans and halts.
  double losses_every_s = 0.0;    ///< The board is gone; a new one is found at once.
  std::uint64_t seed = 1;
};

/// Longest loss by an overrun, s; the number of lost scans is uniform from 1 to this.
inline constexpr double kLongestOverrun_s = 5.0;

/// Adds the faults to a board. Seed and index of the first scan determine the affected scans.
[[nodiscard]] std::unique_ptr<daq::Board> with_faults(std::unique_ptr<daq::Board> board,
                                                      const SimulatedFaults& faults);

}  // namespace stickslip::drivers
