/// \file
/// What the control interface answers. Version 1:
///
///     GET /v1/status   state, board, scan counts, tests; results by the names of the record
///
/// Every refusal is JSON too: {"error": "what is wrong and what is allowed"}.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/daq/board.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/rate_fit.hpp"
#include "core/friction/live_cycle.hpp"
#include "daemon/control/http.hpp"
#include "daemon/test_log.hpp"

namespace stickslip::daemon {

/// A picture of the daemon at one moment.
struct Status {
  /// "starting", "acquiring", "board missing", "board busy", "no permission", "stopping".
  std::string state;
  std::string detail;  ///< The line of STATUS=, for people.
  std::string version;
  std::optional<daq::BoardInfo> board;
  std::string scheduling;
  std::uint64_t scan_count = 0;
  std::uint64_t dropped_scan_count = 0;  ///< By the ring.
  std::uint64_t overrun_count = 0;       ///< By the board.
  std::uint64_t gap_count = 0;
  std::int64_t lost_scan_count = 0;                     ///< In gaps.
  std::uint64_t board_loss_count = 0;                   ///< Times the board went away or failed.
  std::optional<daq::RateEstimate> scan_rate_measured;  ///< Of the board's present life.
  daq::LatencyHistogram latency;                        ///< Of reads.
  std::uint64_t storage_stall_count = 0;
  std::int64_t test_count = 0;               ///< Ended.
  std::optional<std::int64_t> current_test;  ///< Running now.
  std::optional<friction::LiveState> live;   ///< Of the current test.
  pipeline::BenchState bench = pipeline::BenchState::kDegraded;
  std::optional<TestSummary> latest_test;
};

/// \param status  asked for each status request.
[[nodiscard]] HttpHandler make_api(std::function<Status()> status);

}  // namespace stickslip::daemon
