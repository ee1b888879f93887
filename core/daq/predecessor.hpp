/// \file
/// What a board object takes over from the one before it, when a board was lost and is opened again.
#pragma once

#include <optional>

#include "core/daq/board.hpp"
#include "core/daq/rate_meter.hpp"

namespace stickslip::daq {

struct Predecessor {
  std::optional<Continuation> continuation;  ///< The index goes on from it; absent if there was no scan.
  std::optional<BoardInfo> board;            ///< The board that acquired last; absent if none did.
};

}  // namespace stickslip::daq
