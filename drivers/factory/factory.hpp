/// \file
/// The only place that knows which driver stands behind a board.
#pragma once

#include <memory>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/friction/truth.hpp"
#include "drivers/factory/board_config.hpp"

namespace stickslip::drivers {

struct OpenedBoard {
  std::unique_ptr<daq::Board> board;
  std::unique_ptr<friction::TruthSource> truth;  ///< Null if nobody knows the truth.
};

/// \param clock  outlives the board.
/// Errors: kUsage if the configuration or a file it names is wrong; kFailure if the board is not
/// there, in which case a later try may succeed.
[[nodiscard]] base::Result<OpenedBoard> open_board(const BoardConfig& config, base::Clock& clock);

/// Reads all that open_board() would read but touches no hardware.
[[nodiscard]] base::Result<void> check_board(const BoardConfig& config);

}  // namespace stickslip::drivers
