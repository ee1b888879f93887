/// \file
/// Board factory, the only place that distinguishes drivers.
#pragma once

#include <memory>
#include <optional>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/predecessor.hpp"
#include "core/daq/recorded_facts.hpp"
#include "core/model/tester.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"
#include "drivers/factory/board_config.hpp"

namespace stickslip::drivers {

struct OpenedBoard {
  std::unique_ptr<daq::Board> board;
  std::shared_ptr<const model::TruthSource> truth;  ///< Null if there is no truth.
  // Properties of the bench known from a scene or a record; absent for hardware.
  std::optional<daq::LoadCell> load_cell;
  std::optional<model::Tester> tester;
  std::string characterisation;  ///< Of a replayed record: text of its tester's characterisation.
  std::shared_ptr<const daq::RecordedFacts> recorded;  ///< Null unless a record is replayed.
  record::CalibrationFacts calibration{};              ///< Of load_cell, from a replayed record.
  // Of a replayed record: its process.kept and process.estimator.
  std::string kept{};
  std::string estimator{};
};

/// \param clock  outlives the board.
/// \param before  of an earlier acquisition; needed only by boards that can be unplugged.
/// Errors: kUsage if the configuration or a file it names is wrong; kFailure if the board is not there, in
/// which case a later try may succeed.
[[nodiscard]] base::Result<OpenedBoard> open_board(const BoardConfig& config, base::Clock& clock,
                                                   const daq::Predecessor& before = {});

/// Reads and checks everything that open_board() would read, without accessing hardware.
[[nodiscard]] base::Result<void> check_board(const BoardConfig& config);

}  // namespace stickslip::drivers
