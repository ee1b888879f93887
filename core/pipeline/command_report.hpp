/// \file
/// What became of a command to the bench.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/scan_index.hpp"
#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {

struct CommandReport {
  std::string refusal;                       ///< Why nothing was done, for people; empty: it was done.
  BenchState state = BenchState::kDegraded;  ///< Afterwards.
  std::int64_t test = 0;     ///< The running test, else the next one; of a stop: the test that it ended.
  base::ScanIndex scan = 0;  ///< Where it takes effect.
};

struct TareReport : CommandReport {
  double zero_V = 0.0;                 ///< The new one.
  double zero_standard_error_V = 0.0;  ///< As far as the scatter of the scans tells.
  double moved_N = 0.0;                ///< By so much the force is less from here on.
  std::size_t scan_count = 0;          ///< Looked at.
};

}  // namespace stickslip::pipeline
