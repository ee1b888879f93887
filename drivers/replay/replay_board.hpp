/// \file
/// Replay of a record as a board; it gives the same results to the last bit.
#pragma once

#include <memory>

#include "core/base/clock.hpp"
#include "core/daq/board.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"

namespace stickslip::drivers {

/// A board that plays a record, and the record's truth.
struct Replay {
  std::unique_ptr<daq::Board> board;
  std::unique_ptr<model::TruthSource> truth;  ///< Never null; returns nullopt if the record has no truth.
};

/// Scan i after the first is due (i + 1)/granted rate after start(), by `clock`; a gap in the record
/// is a jump in the index. The record pauses while stopped: after stop(), start() continues with the first
/// scan not delivered. After the last scan: kEndOfInput.
/// \param record  kept; \param clock  outlives the board.
[[nodiscard]] Replay make_replay(record::Record record, base::Clock& clock);

}  // namespace stickslip::drivers
