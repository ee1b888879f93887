#include "daemon/control/metrics.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "core/base/text.hpp"

namespace stickslip::control {
namespace {

class Page {
 public:
  void head(std::string_view name, std::string_view type, std::string_view help) {
    text_ += fmt::format("# HELP stickslip_{0} {1}\n# TYPE stickslip_{0} {2}\n", name, help, type);
  }
  template <typename Number>
  void value(std::string_view name, Number number, std::string_view labels = {}) {
    text_ += fmt::format("stickslip_{}{} {}\n", name, labels, number);
  }
  template <typename Number>
  void counter(std::string_view name, std::string_view help, Number number) {
    head(name, "counter", help);
    value(name, number);
  }
  template <typename Number>
  void gauge(std::string_view name, std::string_view help, Number number) {
    head(name, "gauge", help);
    value(name, number);
  }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// Writes a histogram of Prometheus. Its buckets are the bins of LatencyHistogram.
void histogram(Page& page, std::string_view name, std::string_view help,
               const daq::LatencyHistogram& histogram) {
  page.head(name, "histogram", help);
  const std::string bucket = fmt::format("{}_bucket", name);
  std::uint64_t count = 0;
  for (std::size_t bin = 0; bin < daq::LatencyHistogram::kBins; ++bin) {
    count += static_cast<std::uint64_t>(histogram.counts()[bin]);
    const double limit_s = daq::LatencyHistogram::limit_s(bin);
    if (!std::isfinite(limit_s)) continue;
    page.value(bucket, count, fmt::format("{{le=\"{}\"}}", limit_s));
  }
  page.value(bucket, count, "{le=\"+Inf\"}");
  page.value(fmt::format("{}_sum", name), histogram.sum_s());
  page.value(fmt::format("{}_count", name), count);
}

/// Writes the gauges of the control charts.
void charts(Page& page, const daemon::TrendState& state) {
  using Chart = daemon::TrendState::Chart;
  const auto gauge = [&](std::string_view name, std::string_view help, const auto& value) {
    page.head(name, "gauge", help);
    for (const Chart& chart : state.charts)
      page.value(name, value(chart), fmt::format("{{chart=\"{}\"}}", trend::kind_of(chart.quantity).name));
  };
  gauge("trend_alarm", "1 while a control chart of the tester has an alarm that nobody has acknowledged.",
        [](const Chart& chart) { return chart.alarm ? 1 : 0; });
  gauge("trend_tests", "Tests on the control chart since its restart.",
        [](const Chart& chart) { return chart.test_count; });
  gauge("trend_upper", "Arm of the CUSUM for rising values, standard deviations; an alarm above 7.",
        [](const Chart& chart) { return chart.upper; });
  gauge("trend_lower", "Arm of the CUSUM for falling values, standard deviations; an alarm above 7.",
        [](const Chart& chart) { return chart.lower; });
}

/// Text of a label: printable, with backslash and quote escaped.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : base::printable(text)) {
    if (c == '\\' || c == '"') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::string metrics_text(const daemon::Status& status) {
  Page page;
  page.head("build_info", "gauge", "Always 1; the label says which program this is.");
  page.value("build_info", 1, fmt::format("{{version=\"{}\"}}", escaped(status.version)));
  page.head("bench_state", "gauge", "1 for the state that the bench is in, 0 for the others.");
  for (std::size_t i = 0; i < pipeline::kBenchStates; ++i) {
    const auto state = static_cast<pipeline::BenchState>(i);
    page.value("bench_state", status.bench == state ? 1 : 0,
               fmt::format("{{state=\"{}\"}}", pipeline::name(state)));
  }
  page.gauge("board_acquiring", "1 while scans come from the board.", status.state == "acquiring" ? 1 : 0);
  page.counter("scans_total", "Scans processed.", status.scan_count);
  page.counter("gaps_total", "Jumps of the scan index.", status.gap_count);
  page.counter("lost_scans_total", "Scans missing in gaps.", status.lost_scan_count);
  page.counter("dropped_scans_total", "Scans that a full ring did not take.", status.dropped_scan_count);
  page.counter("overruns_total", "Times the board lost scans and halted.", status.overrun_count);
  page.counter("board_losses_total", "Times the board went away or failed.", status.board_loss_count);
  if (status.ring) {
    page.gauge("ring_capacity_blocks", "Blocks that the ring between acquisition and detector holds.",
               status.ring->capacity);
    page.gauge("ring_high_water_blocks", "Most of them that waited at once since the board was opened.",
               status.ring->high_water);
  }
  page.counter("storage_stalls_total", "Times the processing thread waited for the storage thread.",
               status.storage_stall_count);
  page.counter("tests_total", "Tests ended.", status.test_count);
  page.head("findings_total", "counter", "Tests ended with this finding.");
  for (const base::FindingKind& kind : base::finding_kinds()) {
    page.value("findings_total", status.finding_counts[static_cast<std::size_t>(kind.code)],
               fmt::format("{{code=\"{}\",severity=\"{}\"}}", kind.name, base::name(kind.severity)));
  }
  page.gauge("bench_findings", "Findings that the bench has now, as GET /v1/status names them.",
             status.findings.size());
  if (!status.trend.charts.empty()) charts(page, status.trend);
  if (status.board) {
    page.gauge("scan_rate_hertz", "Scan rate that the board granted.", status.board->scan_rate_granted_Hz);
  }
  if (status.scan_rate_measured) {
    page.gauge("scan_rate_measured_hertz", "Scan rate by this computer's clock.",
               status.scan_rate_measured->rate_Hz);
  }
  if (status.storage.room_h)
    page.gauge("disk_room_hours", "Room on the disk, as time of recording.", *status.storage.room_h);
  page.gauge("disk_refuses", "1 while the disk refuses what is to be recorded, or its folder is away.",
             status.storage.kind == daemon::StorageState::Kind::kWaiting ? 1 : 0);
  page.gauge("disk_waiting_bytes", "Kept in memory for the disk.", status.storage.waiting_size);
  page.gauge("live_clients", "Clients of the live stream.", status.live_client_count);
  page.counter("live_dropped_frames_total", "Frames that slow clients of the live stream did not get.",
               status.live_dropped_count);
  if (status.fleet) {
    page.gauge("fleet_connected", "1 while the broker of the fleet is there.",
               status.fleet->link == daemon::FleetState::Link::kConnected ? 1 : 0);
    page.gauge("fleet_outbox_results", "Results that the broker has not got.", status.fleet->outbox_count);
    page.gauge("fleet_unsaved_results", "Those of them that wait in memory alone.",
               status.fleet->unsaved_result_count);
    page.counter("fleet_sent_results_total", "Results that the broker has acknowledged.",
                 status.fleet->sent_result_count);
    page.counter("fleet_dropped_results_total", "Results that a full outbox had no room for.",
                 status.fleet->dropped_result_count);
  }
  histogram(page, "read_latency_seconds",
            "From the last scan of a block to the end of the read that brought it.", status.latency);
  histogram(page, "commit_seconds", "To write and sync what a running test had handed over.",
            status.commit_time);
  return std::move(page).text();
}

}  // namespace stickslip::control
