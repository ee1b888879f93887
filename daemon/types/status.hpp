/// \file
/// A snapshot of the daemon, as GET /v1/status returns it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/daq/board.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/rate_fit.hpp"
#include "core/daq/scan_ring.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/pipeline/bench_state.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/fleet_state.hpp"
#include "daemon/types/lease_state.hpp"
#include "daemon/types/scan_account.hpp"
#include "daemon/types/storage_state.hpp"
#include "daemon/types/test_log.hpp"
#include "daemon/types/trend_state.hpp"

namespace stickslip::daemon {

/// A snapshot of the daemon. Counts run since the start of the program unless stated otherwise.
struct Status {
  /// "starting", "acquiring", "storage short", "storage waiting" (both while acquiring), "board missing",
  /// "board busy", "no permission", "stopping".
  std::string state;
  std::string detail;  ///< One line for people, as STATUS= tells the service manager.
  std::string version;
  std::optional<daq::BoardInfo> board;
  std::string scheduling;
  std::uint64_t scan_count = 0;
  std::uint64_t dropped_scan_count = 0;  ///< Dropped because the ring was full.
  std::uint64_t overrun_count = 0;       ///< Times the board lost scans and halted.
  std::uint64_t gap_count = 0;
  std::int64_t lost_scan_count = 0;  ///< Scans missing in gaps.
  ScanAccount scans;
  std::uint64_t board_loss_count = 0;                   ///< Times the board went away or failed.
  std::optional<daq::RateEstimate> scan_rate_measured;  ///< Since the board was opened.
  daq::LatencyHistogram latency;                        ///< From a block's last scan to the end of its read.
  std::optional<daq::ScanRing::Use> ring;               ///< Since the board was opened.
  daq::LatencyHistogram commit_time;                    ///< Time to write and sync a journal's new entries.
  /// Times that the processing thread waited for the storage thread.
  std::uint64_t storage_stall_count = 0;
  std::int64_t test_count = 0;               ///< Tests that have ended.
  std::optional<std::int64_t> current_test;  ///< Number of the running test; absent: none.
  std::optional<detect::LiveState> live;     ///< Of the running test.
  pipeline::BenchState bench = pipeline::BenchState::kDegraded;
  std::string_view bench_trouble;  ///< Why the bench stays in its state; empty: no trouble.
  std::optional<TestSummary> latest_test;
  StorageState storage;
  /// Calibration of the load cell; unknown texts are empty.
  struct Calibration {
    std::string date;
    std::string expires;
    bool expired = false;
    std::string under_way_by;  ///< Controller of the calibration under way; empty: none.
  } calibration;
  LeaseState lease;
  std::vector<base::Finding> findings;  ///< Of the bench now; those of a test are in its results.
  FindingCounts finding_counts{};       ///< Over all tests that have ended.
  std::optional<BatchProgress> batch;   ///< The current batch; absent: none.
  TrendState trend;                     ///< Control charts of the tester.
  std::optional<FleetState> fleet;      ///< Absent: no broker is configured.
  record::Metadata facts;               ///< Of the next test, by plan and broker.
  /// The live page over TCP.
  struct Page {
    std::string address;     ///< "http://127.0.0.1:8037/"
    std::string token_file;  ///< Absolute path. The token itself is never shown.
  };
  std::optional<Page> page;              ///< Absent: [control] http is not set.
  std::int64_t live_client_count = 0;    ///< Clients of the live stream.
  std::uint64_t live_dropped_count = 0;  ///< Frames dropped for slow clients.
};

/// The status as JSON, with the names of the record.
[[nodiscard]] nlohmann::ordered_json status_json(const Status& status);
/// A test as JSON. \param with_details  adds units, uncertainties and reasons of all results.
[[nodiscard]] nlohmann::ordered_json test_json(const TestSummary& test, bool with_details);
/// {"id": …, "name": …, "done": 3, "planned": 10, "next": {…}, "trouble": null,
/// "under_way": [{"test": 4, …}]}, or null.
[[nodiscard]] nlohmann::ordered_json progress_json(const std::optional<BatchProgress>& progress);
/// {"controller": "ada", "seconds_left": 29.5}; controller is null if nobody has the bench.
[[nodiscard]] nlohmann::ordered_json lease_json(const LeaseState& lease);
/// A frame of the live stream: {"type": "health", "status": …}.
[[nodiscard]] std::string health_frame(const Status& status);
/// Phase, regime and latest cycle of the running test.
[[nodiscard]] nlohmann::ordered_json live_json(const detect::LiveState& live);

}  // namespace stickslip::daemon
