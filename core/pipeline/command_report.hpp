/// \file
/// Outcome of a command to the bench.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/scan_index.hpp"
#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {

/// Outcome of a command. If nothing was done, `test` and `scan` may be 0.
struct CommandReport {
  std::string refusal;                       ///< Reason for a refusal, for the user; empty: done.
  BenchState state = BenchState::kDegraded;  ///< State after the command.
  std::int64_t test = 0;                     ///< The test that runs or that a stop ended; else the next one.
  base::ScanIndex scan = 0;                  ///< First scan affected; of a stop or a mark the latest scan.
};

/// Outcome of a tare. If it was refused, its numbers mean nothing.
struct TareReport : CommandReport {
  double zero_V = 0.0;                 ///< New zero of the load cell.
  double zero_standard_error_V = 0.0;  ///< From the scatter of the scans.
  double moved_N = 0.0;                ///< Decrease of all forces in the coming tests, N.
  std::size_t scan_count = 0;          ///< Scans used.
};

}  // namespace stickslip::pipeline
