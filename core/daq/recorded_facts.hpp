/// \file
/// What a record says about its scans that a replay cannot see: the clocks of then, why scans are missing,
/// and what people did.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/note.hpp"
#include "core/daq/self_check.hpp"

namespace stickslip::daq {

struct RecordedFacts {
  std::vector<ClockAnchor> anchors;             ///< Rising.
  std::vector<Gap> gaps;                        ///< Rising.
  std::shared_ptr<const SelfCheck> self_check;  ///< Null if there is none.
  std::optional<LatencyHistogram> read_latency;
  std::vector<Note> notes{};  ///< Scans not falling.
  /// Of the unloaded cell before the test, as a coefficient; absent where it was not known.
  std::optional<double> unloaded_level = {};
};

}  // namespace stickslip::daq
