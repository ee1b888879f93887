/// \file
/// What a board object takes over from the one before it, when a board was lost and is opened again.
#pragma once

#include <optional>

#include "core/daq/board.hpp"
#include "core/daq/rate_meter.hpp"

namespace stickslip::daq {

struct Predecessor {
  /// The index goes on from it; absent as RateMeter::continuation(): no scan came.
  std::optional<Continuation> continuation;
  std::optional<BoardInfo> board;  ///< The board that acquired last; absent if none did.
};

}  // namespace stickslip::daq
