/// \file
/// What a record says about its scans that a replay cannot see: the clocks of then, and why scans are
/// missing.
#pragma once

#include <optional>
#include <vector>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/latency_histogram.hpp"

namespace stickslip::daq {

/// Anchors and gaps rise.
struct RecordedFacts {
  std::vector<ClockAnchor> anchors;
  std::vector<Gap> gaps;
  std::optional<LatencyHistogram> read_latency;
};

}  // namespace stickslip::daq
