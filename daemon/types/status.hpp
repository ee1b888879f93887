/// \file
/// A picture of the daemon, as GET /v1/status gives it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/daq/board.hpp"
#include "core/daq/latency_histogram.hpp"
#include "core/daq/rate_fit.hpp"
#include "core/daq/scan_ring.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/pipeline/bench_state.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/fleet_state.hpp"
#include "daemon/types/scan_account.hpp"
#include "daemon/types/storage_state.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::daemon {

/// A picture of the daemon at one moment.
struct Status {
  /// "starting", "acquiring", "storage short", "storage waiting" (both while acquiring), "board missing",
  /// "board busy", "no permission", "stopping".
  std::string state;
  std::string detail;  ///< The line of STATUS=, for people.
  std::string version;
  std::optional<daq::BoardInfo> board;
  std::string scheduling;
  std::uint64_t scan_count = 0;
  std::uint64_t dropped_scan_count = 0;  ///< By the ring.
  std::uint64_t overrun_count = 0;       ///< By the board.
  std::uint64_t gap_count = 0;
  std::int64_t lost_scan_count = 0;  ///< In gaps.
  ScanAccount scans;
  std::uint64_t board_loss_count = 0;                   ///< Times the board went away or failed.
  std::optional<daq::RateEstimate> scan_rate_measured;  ///< Of the board's present life.
  daq::LatencyHistogram latency;                        ///< Of reads.
  std::optional<daq::ScanRing::Use> ring;               ///< Of the board's present life.
  daq::LatencyHistogram commit_time;  ///< Of the disk: until what a journal was given was durable.
  std::uint64_t storage_stall_count = 0;
  std::int64_t test_count = 0;               ///< Ended.
  std::optional<std::int64_t> current_test;  ///< Running now.
  std::optional<detect::LiveState> live;     ///< Of the current test.
  pipeline::BenchState bench = pipeline::BenchState::kDegraded;
  std::string_view bench_trouble;  ///< What keeps it in its state; empty: nothing.
  std::optional<TestSummary> latest_test;
  StorageState storage;
  /// Of the load cell; texts are empty where there is nothing to say.
  struct Calibration {
    std::string date;
    std::string expires;
    bool expired = false;
    std::string under_way_by;  ///< Who is at a new one.
  } calibration;
  std::optional<BatchProgress> batch;  ///< The current one.
  std::optional<FleetState> fleet;     ///< Nothing without a broker.
  /// The live page over TCP.
  struct Page {
    std::string address;     ///< "http://127.0.0.1:8037/"
    std::string token_file;  ///< Absolute; the token itself is told to nobody.
  };
  std::optional<Page> page;              ///< Nothing without [control] http.
  std::int64_t live_client_count = 0;    ///< Of the live stream.
  std::uint64_t live_dropped_count = 0;  ///< Frames that slow ones of them did not get.
};

/// By the names of the record.
[[nodiscard]] nlohmann::ordered_json status_json(const Status& status);
/// \param with_details  units, uncertainties and reasons of all results too.
[[nodiscard]] nlohmann::ordered_json test_json(const TestSummary& test, bool with_details);
/// {"id": …, "name": …, "done": 3, "planned": 10, "next": {…}, "trouble": null}, or null.
[[nodiscard]] nlohmann::ordered_json progress_json(const std::optional<BatchProgress>& progress);
/// A frame of the live stream: {"type": "health", "status": …}.
[[nodiscard]] std::string health_frame(const Status& status);
/// Phase, regime and latest cycle of a test that runs.
[[nodiscard]] nlohmann::ordered_json live_json(const detect::LiveState& live);

}  // namespace stickslip::daemon
