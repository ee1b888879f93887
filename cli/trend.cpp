#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/ask.hpp"
#include "cli/subcommands.hpp"
#include "io/findings_text.hpp"
#include "io/json_text.hpp"
#include "io/print_text.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
#include "core/base/shell_word.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/tester_history.hpp"
#include "daemon/types/trend_state.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kAll = "all";

struct TrendOptions {
  std::string folder = ".";
  bool json = false;
  std::string reference;
  std::string restart;
  std::string reason;
  std::string who;
  bool baseline_stays = false;
  std::vector<std::string> add;
};

std::string now() { return record::iso_time(base::make_system_clock()->realtime_ns()); }

base::Result<void> restart(const TrendOptions& options, const daemon::TesterHistory& history) {
  daemon::ChartsRestarted restarted{.chart = trend::quantity_from_name(options.restart),
                                    .baseline_stays = options.baseline_stays,
                                    .reason = options.reason,
                                    .who = options.who.empty() ? user_name() : options.who};
  if (!restarted.chart && options.restart != kAll) {
    std::string names;
    for (const trend::ChartKind& kind : trend::chart_kinds()) names += fmt::format("{}, ", kind.name);
    return base::usage_error("--restart: \"{}\" is no chart; there are {}{}",
                             base::one_line(options.restart, 60), names, kAll);
  }
  if (options.reason.empty())
    return base::usage_error("--reason: is missing: why is the chart of {} restarted?", options.restart);
  if (const std::string why = base::name_refusal(options.reason); !why.empty())
    return base::usage_error("--reason: {}", why);
  if (history.events().empty()) {
    return base::failure("{}: holds no test: there is no chart to restart; check the folder",
                         history.path().string());
  }
  return history.append({{now(), std::move(restarted)}});
}

/// Appends the records that the history lacks, in the order of their names, which begin with the time. Charts
/// follow the order of lines, so records older than the latest test of the history are told and left out.
base::Result<void> add(const TrendOptions& options, const daemon::TesterHistory& history) {
  std::vector<std::string> files = options.add;
  const auto stem = [](const std::string& file) { return std::filesystem::path{file}.stem().string(); };
  std::sort(files.begin(), files.end(),
            [&stem](const std::string& a, const std::string& b) { return stem(a) < stem(b); });
  std::vector<daemon::HistoryEvent> events;
  const std::string latest = history.records().empty() ? "" : history.records().rbegin()->first;
  std::size_t older = 0;
  for (const std::string& file : files) {
    const auto facts = record::read_facts_apart(file);
    if (!facts) return tl::unexpected(facts.error());
    if (history.has(facts->header.uuid)) continue;
    if (stem(file) <= latest) {
      ++older;
      continue;
    }
    auto event = daemon::test_event(*facts, daemon::name_in_journal(options.folder, file));
    if (!event) return tl::unexpected(event.error());
    events.push_back(*std::move(event));
  }
  if (older > 0) {
    io::print_error("stickslip",
                    fmt::format("warning: {} of {} records are older than {}, the latest in the history, and "
                                "left out: charts follow time; to chart them too, move {} away and add all",
                                older, files.size(), latest, base::printable(history.path().string())));
  }
  return history.append(events);
}

/// With so few digits a row has at most 80 columns.
std::string number_text(const std::optional<double>& value, int digits = 4) {
  return value ? fmt::format("{:.{}g}", *value, digits) : std::string{io::kAbsent};
}

std::string text_of(const TrendOptions& options, const daemon::TrendState& state) {
  using enum io::Table::Align;
  io::Table table{{{.heading = "chart", .align = kLeft},
                   {.heading = "unit", .align = kLeft},
                   {.heading = "tests"},
                   {.heading = "mean"},
                   {.heading = "sd"},
                   {.heading = "latest"},
                   {.heading = "up", .format = ".1f"},
                   {.heading = "down", .format = ".1f"},
                   {.heading = "verdict", .align = kLeft}}};
  std::string reasons;
  for (const daemon::TrendState::Chart& chart : state.charts) {
    const trend::ChartKind& kind = trend::kind_of(chart.quantity);
    table.add({io::cell(kind.name), io::cell(kind.unit), chart.test_count, number_text(chart.mean),
               number_text(chart.standard_deviation, 3), number_text(chart.latest), chart.upper, chart.lower,
               io::cell(trend::name(chart.verdict))});
    if (chart.outside_count > 0)
      reasons += fmt::format("{}: {} of {} beyond 3 sd\n", kind.name, chart.outside_count, chart.test_count);
    if (chart.verdict == trend::Verdict::kOff && !chart.reason.empty())
      reasons += fmt::format("{}: {}\n", kind.name, chart.reason);
  }
  std::string text = table.text();
  text += fmt::format("up, down: CUSUM, k {}, an alarm above h {}; learning: fewer than {} tests\n",
                      trend::kReferenceValue, trend::kDecisionInterval, trend::kFullBaseline);
  text += base::printable_lines(reasons);
  for (const base::Finding& finding : state.findings) {
    text += io::finding_text(finding);
    const std::string chart = finding.code.substr(finding.code.find('-') + 1);
    text += fmt::format("   once it is settled: stickslip trend {} --restart {} --reason TEXT\n",
                        base::shell_word(options.folder), chart);
  }
  return text;
}

base::Result<std::string> run_trend(const TrendOptions& options) {
  std::error_code error;
  if (!std::filesystem::is_directory(options.folder, error))
    return base::usage_error("{}: is no folder; name that of the records", base::printable(options.folder));
  if (options.restart.empty() && (!options.reason.empty() || options.baseline_stays))
    return base::usage_error("--restart: is missing: which chart, or {}?", kAll);
  daemon::TesterHistory history{options.folder};
  const auto warn = [&history]() -> base::Result<void> {
    const auto remarks = history.read_on();
    if (!remarks) return tl::unexpected(remarks.error());
    for (const std::string& remark : *remarks) io::print_error("stickslip", "warning: " + remark);
    return {};
  };
  if (auto read = warn(); !read) return tl::unexpected(read.error());
  if (!options.add.empty()) {
    if (auto added = add(options, history); !added) return tl::unexpected(added.error());
    if (auto read = warn(); !read) return tl::unexpected(read.error());
  }
  if (!options.restart.empty()) {
    if (auto restarted = restart(options, history); !restarted) return tl::unexpected(restarted.error());
    if (auto read = warn(); !read) return tl::unexpected(read.error());
  }
  if (history.events().empty()) {
    return base::failure(
        "{}: there is no history of a tester; the daemon writes it, or: stickslip trend {} "
        "--add RECORDS",
        base::printable(history.path().string()), base::shell_word(options.folder));
  }
  const auto reference =
      options.reference.empty() ? std::nullopt : std::optional<std::string>{options.reference};
  const base::Result<trend::TesterCharts> charts = daemon::charts_now(history, reference);
  if (!charts) return tl::unexpected(charts.error());
  const daemon::TrendState state = daemon::trend_state(*charts);
  if (!options.json) return text_of(options, state);
  nlohmann::ordered_json json = daemon::trend_course_json(*charts, state);
  json["history"] = history.path().string();
  return io::json_document(json);
}

constexpr const char* kTrendExamples =
    R"(Control charts of the tester (docs/trend.md): reference paper, omega, damping, zero, noise, spikes, rate.

Examples:
  stickslip trend records
  stickslip trend records --restart zero --reason "new load cell"
  stickslip trend records --restart all --baseline-stays --reason "nothing found"
  stickslip trend records --add records/*.h5 --reference "reference 7" --json)";

}  // namespace

void add_trend(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<TrendOptions>();
  CLI::App* command = app.add_subcommand("trend", "has the tester shifted? Control charts over its tests");
  command->footer(kTrendExamples);
  command->add_option("folder", options->folder, "of the records and the history; default: this one")
      ->type_name("FOLDER");
  command->add_flag("--json", options->json, "JSON instead of a table");
  command
      ->add_option("--reference", options->reference,
                   "sample that is the reference paper; default: as the daemon was configured")
      ->type_name("TEXT");
  command->add_option("--restart", options->restart, "acknowledge the alarm of a chart, or of all")
      ->type_name("CHART");
  command->add_option("--reason", options->reason, "such as \"new load cell\"")->type_name("TEXT");
  command->add_option("--as", options->who, "who does; default: user and host")->type_name("NAME");
  command->add_flag("--baseline-stays", options->baseline_stays,
                    "nothing had changed: go on with the baseline of before");
  command->add_option("--add", options->add, "records that the history lacks")->type_name("FILE.h5");
  choose(*command, chosen, [options] { return run_trend(*options); });
}

}  // namespace stickslip::cli
