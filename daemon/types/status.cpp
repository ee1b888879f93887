#include "daemon/types/status.hpp"

#include <cmath>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finding_json.hpp"
#include "daemon/types/batch_json.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const daq::BoardInfo& board) {
  Json json;
  json["driver"] = board.driver;
  json["name"] = board.board_name;
  json["device"] = board.device;
  json["serial"] = board.serial.empty() ? Json(nullptr) : Json(board.serial);
  json["bus_path"] = board.bus_path.empty() ? Json(nullptr) : Json(board.bus_path);
  json["subdevice"] = board.subdevice;
  json["channel"] = board.channel;
  json["scan_rate_requested"] = board.scan_rate_requested_Hz;
  json["scan_rate_granted"] = board.scan_rate_granted_Hz;
  json["maxdata"] = board.maxdata;
  json["range_min"] = board.range_min_V;
  json["range_max"] = board.range_max_V;
  json["calibration"] = board.calibration.empty() ? Json(nullptr) : Json(board.calibration);
  json["acquisition"] = board.acquisition.empty() ? Json(nullptr) : Json(board.acquisition);
  json["notes"] = board.notes;
  json["second"] = nullptr;
  if (board.second) {
    json["second"] = {{"quantity", daq::name(board.second->quantity)},
                      {"channel", board.second->channel},
                      {"maxdata", board.second->maxdata},
                      {"range_min", board.second->range_min_V},
                      {"range_max", board.second->range_max_V}};
  }
  return json;
}

Json to_json(const std::optional<daq::RateEstimate>& rate) {
  if (!rate) return nullptr;
  return {{"value", rate->rate_Hz},
          {"standard_error", rate->standard_error_Hz},
          {"clock_reading_count", rate->anchor_count}};
}

/// A histogram as JSON, without its empty bins.
/// \param of_what  name of the number in a bin.
Json to_json(const daq::LatencyHistogram& latency, const char* of_what) {
  Json bins = Json::array();
  for (std::size_t bin = 0; bin < daq::LatencyHistogram::kBins; ++bin) {
    if (latency.counts()[bin] == 0) continue;
    bins.push_back(
        {{"below", io::or_null(daq::LatencyHistogram::limit_s(bin))}, {of_what, latency.counts()[bin]}});
  }
  return {{"largest", latency.largest_s()}, {"bins", bins}};
}

Json to_json(const std::optional<daq::ScanRing::Use>& ring) {
  if (!ring) return nullptr;
  return {{"capacity_block_count", ring->capacity}, {"high_water_block_count", ring->high_water}};
}

Json or_nothing(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json to_json(const Status::Calibration& calibration) {
  return {{"date", or_nothing(calibration.date)},
          {"expires", or_nothing(calibration.expires)},
          {"expired", calibration.expired},
          {"under_way_by", or_nothing(calibration.under_way_by)}};
}

Json to_json(const StorageState& storage) {
  return {{"state", name(storage.kind)},
          {"room_h", storage.room_h ? Json(*storage.room_h) : Json(nullptr)},
          {"waiting_size", storage.waiting_size},
          {"why", or_nothing(storage.why)},
          {"to_do", or_nothing(storage.to_do)},
          {"lacks", storage.lacks}};
}

Json to_json(const std::optional<Status::Page>& page) {
  if (!page) return nullptr;
  return {{"address", page->address}, {"token_file", page->token_file}};
}

Json to_json(const std::optional<FleetState>& fleet) {
  if (!fleet) return nullptr;
  return {{"broker", fleet->broker},
          {"tester", fleet->tester},
          {"state", name(fleet->link)},
          {"why", fleet->why.empty() ? Json(nullptr) : Json(fleet->why)},
          {"outbox_count", fleet->outbox_count},
          {"sent_result_count", fleet->sent_result_count},
          {"dropped_result_count", fleet->dropped_result_count},
          {"unsaved_result_count", fleet->unsaved_result_count}};
}

}  // namespace

Json test_json(const TestSummary& test, bool with_details) {
  Json json;
  json["number"] = test.number;
  json["first_scan"] = test.earlier ? Json(nullptr) : Json(test.first);
  json["end_scan"] = test.earlier ? Json(nullptr) : Json(test.end);
  json["cause"] = pipeline::name(test.cause);
  json["file"] = test.file.empty() ? Json(nullptr) : Json(test.file);
  if (!test.file_error.empty()) json["file_error"] = test.file_error;
  json["results"] = io::results_json(test.results, with_details);
  return json;
}

/// A cycle as JSON, with names and units of the table of cycles in a record.
Json live_json(const detect::LiveState& live) {
  Json json;
  json["phase"] = detect::name(live.phase);
  json["regime"] = model::name(live.regime);
  json["slip_count"] = live.slip_count;
  json["latest_cycle"] = nullptr;
  if (live.latest) {
    const detect::Cycle& cycle = live.latest->cycle;
    json["latest_cycle"] = {{"number", cycle.number},
                            {"captured", (cycle.flags & detect::kCycleCaptured) != 0},
                            {"evidence", io::or_null(live.latest->evidence)},
                            {"peak_time", io::or_null(cycle.peak_time_s)},
                            {"period", io::or_null(cycle.period_s)},
                            {"force_drop", io::or_null(cycle.force_drop)},
                            {"mu_s", io::or_null(live.latest->S)},
                            {"mu_k", io::or_null(live.latest->K)},
                            {"delta_mu", io::or_null(cycle.delta_mu)},
                            {"delta_mu_standard_error", io::or_null(cycle.delta_mu_standard_error)},
                            {"slip_speed_ratio", io::or_null(cycle.slip_speed_ratio)}};
  }
  return json;
}

Json lease_json(const LeaseState& lease) {
  return {{"controller", or_nothing(lease.controller)}, {"seconds_left", lease.seconds_left}};
}

std::string health_frame(const Status& status) {
  return io::json_text(Json{{"type", "health"}, {"status", status_json(status)}});
}

Json progress_json(const std::optional<BatchProgress>& progress) {
  if (!progress) return nullptr;
  Json under_way = Json::array();
  for (const StepUnderWay& one : progress->under_way) {
    Json json{{"test", one.test}};
    json.update(step_json(one.step));
    under_way.push_back(std::move(json));
  }
  return {{"id", progress->id},
          {"name", progress->name},
          {"done", progress->done},
          {"planned", progress->planned},
          {"next", progress->next ? step_json(*progress->next) : Json(nullptr)},
          {"trouble", progress->trouble.empty() ? Json(nullptr) : Json(progress->trouble)},
          {"under_way", std::move(under_way)}};
}

Json status_json(const Status& status) {
  Json json;
  json["state"] = status.state;
  json["bench"] = pipeline::name(status.bench);
  json["bench_trouble"] = status.bench_trouble.empty() ? Json(nullptr) : Json(status.bench_trouble);
  json["detail"] = status.detail;
  json["version"] = status.version;
  json["board"] = status.board ? to_json(*status.board) : Json(nullptr);
  json["scheduling"] = status.scheduling;
  json["scan_count"] = status.scan_count;
  json["dropped_scan_count"] = status.dropped_scan_count;
  json["overrun_count"] = status.overrun_count;
  json["gap_count"] = status.gap_count;
  json["lost_scan_count"] = status.lost_scan_count;
  json["scans"] = {{"issued", status.scans.issued},
                   {"recorded", status.scans.recorded},
                   {"idle", status.scans.idle},
                   {"in_gaps", status.scans.in_gaps},
                   {"damaged", status.scans.damaged},
                   {"unsaved", status.scans.unsaved},
                   {"under_way", status.scans.under_way()}};
  json["board_loss_count"] = status.board_loss_count;
  json["scan_rate_measured"] = to_json(status.scan_rate_measured);
  json["read_latency"] = to_json(status.latency, "read_count");
  json["ring"] = to_json(status.ring);
  json["commit_time"] = to_json(status.commit_time, "commit_count");
  json["storage_stall_count"] = status.storage_stall_count;
  json["storage"] = to_json(status.storage);
  json["calibration"] = to_json(status.calibration);
  json["lease"] = lease_json(status.lease);
  Json counts = Json::object();
  record::put_findings(status.findings, json);
  for (const base::FindingKind& kind : base::finding_kinds()) {
    if (const auto count = status.finding_counts[static_cast<std::size_t>(kind.code)]; count > 0)
      counts[std::string{kind.name}] = count;
  }
  json["finding_counts"] = std::move(counts);
  json["trend"] = trend_json(status.trend);
  json["live_clients"] = {{"count", status.live_client_count},
                          {"dropped_frame_count", status.live_dropped_count}};
  json["page"] = to_json(status.page);
  json["fleet"] = to_json(status.fleet);
  json["next_facts"] = status.facts;
  json["test_count"] = status.test_count;
  json["current_test"] = status.current_test ? Json(*status.current_test) : Json(nullptr);
  json["live"] = status.live ? live_json(*status.live) : Json(nullptr);
  json["batch"] = progress_json(status.batch);
  json["latest_test"] = status.latest_test ? test_json(*status.latest_test, false) : Json(nullptr);
  return json;
}

}  // namespace stickslip::daemon
