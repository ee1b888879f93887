/// \file
/// What a record says about its scans that a replay cannot see: the clocks of then, and why scans are
/// missing.
#pragma once

#include <vector>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::daq {

/// Both rise.
struct RecordedFacts {
  std::vector<ClockAnchor> anchors;
  std::vector<Gap> gaps;
};

}  // namespace stickslip::daq
