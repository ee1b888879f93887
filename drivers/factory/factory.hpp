/// \file
/// The only place that knows which driver stands behind a board.
#pragma once

#include <memory>
#include <optional>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/rate_meter.hpp"
#include "core/daq/recorded_facts.hpp"
#include "core/model/tester.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"
#include "drivers/factory/board_config.hpp"

namespace stickslip::drivers {

struct OpenedBoard {
  std::unique_ptr<daq::Board> board;
  std::shared_ptr<const model::TruthSource> truth;  ///< Null if nobody knows the truth.
  // What the source of the scans knows about the bench behind them; absent for hardware.
  std::optional<daq::LoadCell> load_cell;
  std::optional<model::Tester> tester;
  std::string characterisation;  ///< Of a replayed record: what was known of its tester beforehand.
  std::shared_ptr<const daq::RecordedFacts> recorded;  ///< Null unless a record is replayed.
  record::CalibrationFacts calibration{};              ///< Of load_cell, as a replayed record knows it.
  // Of a replayed record: its process.kept and process.estimator.
  std::string kept{};
  std::string estimator{};
};

/// \param clock  outlives the board.
/// \param continues  where the acquisition before this one ended; only boards that can go away need it.
/// Errors: kUsage if the configuration or a file it names is wrong; kFailure if the board is not
/// there, in which case a later try may succeed.
[[nodiscard]] base::Result<OpenedBoard> open_board(const BoardConfig& config, base::Clock& clock,
                                                   const std::optional<daq::Continuation>& continues = {});

/// Reads all that open_board() would read but touches no hardware.
[[nodiscard]] base::Result<void> check_board(const BoardConfig& config);

}  // namespace stickslip::drivers
