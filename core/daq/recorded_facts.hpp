/// \file
/// Data of a record that a replay of its scans cannot reproduce: clock anchors, causes of gaps, self-check,
/// delays of the reads, notes, and the level of the unloaded cell.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/note.hpp"
#include "core/daq/self_check_values.hpp"

namespace stickslip::daq {

struct RecordedFacts {
  std::vector<ClockAnchor> anchors;             ///< In the order of their scans.
  std::vector<Gap> gaps;                        ///< In the order of their scans.
  std::shared_ptr<const SelfCheck> self_check;  ///< Null if absent.
  std::optional<LatencyHistogram> read_latency;
  std::vector<Note> notes{};  ///< In the order of their scans.
  /// Coefficient read by the unloaded cell before the test; nullopt if unknown.
  std::optional<double> unloaded_level = {};
};

}  // namespace stickslip::daq
