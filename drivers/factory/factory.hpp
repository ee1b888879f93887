/// \file
/// The only place that knows which driver stands behind a board.
#pragma once

#include <memory>
#include <optional>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/friction/tester.hpp"
#include "core/friction/truth.hpp"
#include "drivers/factory/board_config.hpp"

namespace stickslip::drivers {

struct OpenedBoard {
  std::unique_ptr<daq::Board> board;
  std::shared_ptr<const friction::TruthSource> truth;  ///< Null if nobody knows the truth.
  // What the source of the scans knows about the bench behind them; absent for hardware.
  std::optional<daq::LoadCell> load_cell;
  std::optional<friction::Tester> tester;
  std::string characterisation;  ///< Of a replayed record: what was known of its tester beforehand.
};

/// \param clock  outlives the board.
/// Errors: kUsage if the configuration or a file it names is wrong; kFailure if the board is not
/// there, in which case a later try may succeed.
[[nodiscard]] base::Result<OpenedBoard> open_board(const BoardConfig& config, base::Clock& clock);

/// Reads all that open_board() would read but touches no hardware.
[[nodiscard]] base::Result<void> check_board(const BoardConfig& config);

}  // namespace stickslip::drivers
