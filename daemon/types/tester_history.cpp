#include "daemon/types/tester_history.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/journal_format.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/quantity_json.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;
using trend::Quantity;

constexpr std::string_view kChecksum = R"(,"crc32c":")";
constexpr std::string_view kAllCharts = "all";
constexpr std::string_view kNewBaseline = "new";
constexpr std::string_view kOldBaseline = "stays";

std::string checksum_of(std::string_view text) {
  return fmt::format("{:08x}", record::crc32c(std::as_bytes(std::span{text})));
}

std::optional<double> number_at(const Json& json, std::string_view key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? std::optional{found->get<double>()} : std::nullopt;
}

base::Result<TestFinished> test_of(const Json& json, const std::string& at) {
  TestFinished test;
  auto uuid = text_at(json, "uuid");
  if (!uuid) return tl::unexpected(uuid.error());
  test.uuid = *std::move(uuid);
  const auto word = text_at(json, "status");
  if (!word) return tl::unexpected(word.error());
  const std::optional<record::Status> status = record::status_from_name(*word);
  if (!status) return base::usage_error("\"{}\" is no status of a test", base::one_line(*word, 60));
  test.status = *status;
  auto file = text_at(json, "file");
  if (!file) return tl::unexpected(file.error());
  test.values.time = at;
  test.values.file = *std::move(file);
  if (auto sample = text_at(json, "sample")) test.values.sample = *std::move(sample);
  test.values.pull_speed_m_per_s = number_at(json, "pull_speed_m_per_s");
  test.values.mu_k = number_at(json, "mu_k");
  test.values.delta_mu = number_at(json, "delta_mu");
  for (std::size_t i = 0; i < trend::kQuantities; ++i) {
    if (const std::string_view key = trend::chart_kinds()[i].key; !key.empty())
      test.values.values[i] = number_at(json, key);
  }
  return test;
}

base::Result<ChartsRestarted> restart_of(const Json& json) {
  ChartsRestarted restart;
  const auto chart = text_at(json, "chart");
  if (!chart) return tl::unexpected(chart.error());
  if (*chart != kAllCharts) {
    restart.chart = trend::quantity_from_name(*chart);
    if (!restart.chart) return base::usage_error("\"{}\" is no chart", base::one_line(*chart, 60));
  }
  const auto baseline = text_at(json, "baseline");
  if (!baseline) return tl::unexpected(baseline.error());
  if (*baseline != kOldBaseline && *baseline != kNewBaseline)
    return base::usage_error("\"{}\" is no baseline", base::one_line(*baseline, 60));
  restart.baseline_stays = *baseline == kOldBaseline;
  for (const auto& [key, text] : {std::pair{"reason", &restart.reason}, {"by", &restart.who}}) {
    auto found = text_at(json, key);
    if (!found) return tl::unexpected(found.error());
    *text = *std::move(found);
  }
  return restart;
}

}  // namespace

base::Result<HistoryEvent> test_event(const record::Record& record, const std::string& name) {
  if (!record.end) return base::usage_error("{}: holds no end of a test", name);
  const record::RecordHeader& header = record.header;
  const record::EndRecord& end = *record.end;
  const analysis::TestResults& results = end.results;
  TestFinished test{.uuid = header.uuid, .status = end.status, .values = {}};
  test.values.file = name;
  test.values.sample = header.sample.name;
  test.values.pull_speed_m_per_s = header.tester.pull_speed_m_per_s;
  test.values.mu_k = results.mu_k.value;
  test.values.delta_mu = results.delta_mu.value;
  const auto value = [&test](Quantity quantity) -> std::optional<double>& {
    return test.values.values[static_cast<std::size_t>(quantity)];
  };
  if (header.process.characterisation.empty()) {
    value(Quantity::kOmega) = results.omega.value;
    value(Quantity::kDamping) = results.gamma_over_2omega.value;
  }
  if (header.self_check) {
    value(Quantity::kZero) = header.self_check->zero_N;
    value(Quantity::kNoise) = header.self_check->noise_N;
  }
  const double rate_Hz = header.board.scan_rate_granted_Hz;
  if (results.spike_count.value && header.start_realtime_ns && end.end_realtime_ns && rate_Hz > 0.0) {
    // Both times are scan indices over the granted rate.
    const double scans =
        1e-9 * static_cast<double>(*end.end_realtime_ns - *header.start_realtime_ns) * rate_Hz;
    if (scans >= 1.0) value(Quantity::kSpikes) = *results.spike_count.value / scans;
  }
  if (results.scan_rate_measured.value && rate_Hz > 0.0)
    value(Quantity::kRate) = *results.scan_rate_measured.value / rate_Hz - 1.0;
  test.values.time = header.start_realtime_ns ? record::iso_time(*header.start_realtime_ns) : std::string{};
  return HistoryEvent{test.values.time, std::move(test)};
}

std::string line_of(const HistoryEvent& event) {
  Json json{{"at", event.at}};
  if (const auto* test = std::get_if<TestFinished>(&event.what)) {
    json.update({{"event", "test"},
                 {"uuid", test->uuid},
                 {"file", test->values.file},
                 {"status", record::name(test->status)},
                 {"sample", test->values.sample},
                 {"pull_speed_m_per_s", io::or_null(test->values.pull_speed_m_per_s)},
                 {"mu_k", io::or_null(test->values.mu_k)},
                 {"delta_mu", io::or_null(test->values.delta_mu)}});
    for (std::size_t i = 0; i < trend::kQuantities; ++i) {
      if (const std::string_view key = trend::chart_kinds()[i].key; !key.empty())
        json[std::string{key}] = io::or_null(test->values.values[i]);
    }
  } else if (const auto* restart = std::get_if<ChartsRestarted>(&event.what)) {
    json.update({{"event", "restart"},
                 {"chart", restart->chart ? trend::kind_of(*restart->chart).name : kAllCharts},
                 {"baseline", restart->baseline_stays ? kOldBaseline : kNewBaseline},
                 {"reason", restart->reason},
                 {"by", restart->who}});
  } else {
    json.update({{"event", "reference"}, {"sample", std::get<ReferenceNamed>(event.what).sample}});
  }
  std::string text = io::json_text(json);
  text.pop_back();  // The brace, which comes behind the checksum.
  return fmt::format("{}{}{}\"}}", text, kChecksum, checksum_of(text));
}

base::Result<HistoryEvent> history_event_of(std::string_view line) {
  const std::size_t mark = line.rfind(kChecksum);
  if (mark == std::string_view::npos) return base::usage_error("has no checksum");
  if (line.substr(mark) != fmt::format("{}{}\"}}", kChecksum, checksum_of(line.substr(0, mark))))
    return base::usage_error("was changed or damaged: its checksum is another");
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return base::usage_error("is no JSON object");
  HistoryEvent event;
  const auto kind = text_at(json, "event");
  if (!kind) return tl::unexpected(kind.error());
  auto at = text_at(json, "at");
  if (!at) return tl::unexpected(at.error());
  event.at = *std::move(at);
  if (*kind == "test") {
    auto test = test_of(json, event.at);
    if (!test) return tl::unexpected(test.error());
    event.what = *std::move(test);
  } else if (*kind == "restart") {
    auto restart = restart_of(json);
    if (!restart) return tl::unexpected(restart.error());
    event.what = *std::move(restart);
  } else if (*kind == "reference") {
    auto sample = text_at(json, "sample");
    if (!sample) return tl::unexpected(sample.error());
    event.what = ReferenceNamed{*std::move(sample)};
  } else {
    return base::usage_error("\"{}\" is no event this program knows", base::one_line(*kind, 60));
  }
  return event;
}

base::Result<void> TesterHistory::append(const std::vector<HistoryEvent>& events) const {
  std::vector<std::string> lines;
  lines.reserve(events.size());
  for (const HistoryEvent& event : events) lines.push_back(line_of(event));
  return lines_.append(lines);
}

base::Result<std::vector<std::string>> TesterHistory::read_on() {
  std::vector<std::string> remarks;
  const auto read = lines_.read_on([&](std::string_view line, std::int64_t number) {
    base::Result<HistoryEvent> event = history_event_of(line);
    if (!event) {
      remarks.push_back(
          fmt::format("{}: line {}: {}; it is left out", path().string(), number, event.error().message));
      return;
    }
    if (const auto* test = std::get_if<TestFinished>(&event->what)) {
      if (!uuids_.insert(test->uuid).second) return;
      records_.insert_or_assign(std::filesystem::path{test->values.file}.stem().string(), test->uuid);
    } else if (const auto* named = std::get_if<ReferenceNamed>(&event->what)) {
      reference_ = named->sample;
    }
    events_.push_back(*std::move(event));
  });
  if (!read) return tl::unexpected(read.error());
  return remarks;
}

void TesterHistory::forget() {
  events_.clear();
  while (records_.size() > kRemembered) {
    uuids_.erase(records_.begin()->second);
    records_.erase(records_.begin());
  }
}

trend::TesterCharts TesterHistory::charts(const BatchBook& book,
                                          const std::optional<std::string>& reference) const {
  trend::TesterCharts charts{reference.value_or(reference_)};
  for (const HistoryEvent& event : events_) apply(event, book, charts);
  return charts;
}

base::Result<trend::TesterCharts> charts_now(const TesterHistory& history,
                                             const std::optional<std::string>& reference) {
  BatchJournal batches{history.path().parent_path()};
  BatchBook book;
  if (const auto read = batches.read_on(book); !read) return tl::unexpected(read.error());
  return history.charts(book, reference);
}

std::vector<trend::Quantity> apply(const HistoryEvent& event, const BatchBook& book,
                                   trend::TesterCharts& charts) {
  if (const auto* test = std::get_if<TestFinished>(&event.what)) {
    if (test->status != record::Status::kComplete || book.voided(test->values.file) != nullptr) return {};
    return charts.add(test->values);
  }
  if (const auto* restart = std::get_if<ChartsRestarted>(&event.what)) {
    for (std::size_t i = 0; i < trend::kQuantities; ++i) {
      const auto quantity = static_cast<Quantity>(i);
      if (!restart->chart || *restart->chart == quantity) charts.restart(quantity, restart->baseline_stays);
    }
  }
  return {};
}

}  // namespace stickslip::daemon
