/// \file
/// A record as a board: the same walk of a scan, the same results to the last bit.
#pragma once

#include <memory>

#include "core/base/clock.hpp"
#include "core/daq/board.hpp"
#include "core/model/truth.hpp"
#include "core/record/record.hpp"

namespace stickslip::drivers {

/// A board that plays a record, and what the record knows of the truth.
struct Replay {
  std::unique_ptr<daq::Board> board;
  std::unique_ptr<model::TruthSource> truth;  ///< Never null; answers nothing if the record has none.
};

/// Scan i after the first is due (i + 1)/granted rate after start(), by `clock`; a gap in the record
/// is a jump in the index. A record does not run on without its reader: after stop(), start() goes on
/// with the first scan not delivered. After the last scan: kEndOfInput.
/// \param record  kept; \param clock  outlives the board.
[[nodiscard]] Replay make_replay(record::Record record, base::Clock& clock);

}  // namespace stickslip::drivers
