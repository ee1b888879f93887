// Whatever names a record, a request or a file brings: each output keeps its lines and its format.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "io/export_csv.hpp"
#include "io/table.hpp"
#include "io/verify.hpp"
#include "report/plot/script.hpp"
#include "report/report_json.hpp"
#include "report/report_page.hpp"
#include "report/report_text.hpp"
#include <nlohmann/json.hpp>

#include "daemon/control/metrics.hpp"
#include "daemon/fleet/messages.hpp"
#include "daemon/types/status.hpp"
#include "tests/support/hostile_text.hpp"
#include "tests/support/journal_samples.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/support/report_samples.hpp"

namespace stickslip::report {
namespace {

using test::expect_safe;
using test::hostile;
using test::lines_of;

/// Never empty: a line may be left out with its text.
std::string next(bool is_hostile) {
  const std::string text = is_hostile ? *hostile() : "";
  return text.empty() ? "plain" : text;
}

/// Every text that a person or another program may have written. \param is_hostile  else the same words
/// everywhere.
record::RecordHeader named_header(bool is_hostile) {
  record::RecordHeader header = test::sample_header();
  record::SampleFacts& sample = header.sample;
  record::CalibrationFacts& calibration = header.calibration;
  record::ProcessFacts& process = header.process;
  for (std::string* text : {&header.title,
                            &header.board.driver,
                            &header.board.board_name,
                            &header.board.device,
                            &header.board.calibration,
                            &header.board.acquisition,
                            &sample.name,
                            &sample.grade,
                            &sample.direction,
                            &sample.side,
                            &sample.batch,
                            &sample.operator_name,
                            &calibration.date,
                            &calibration.certificate,
                            &calibration.expires,
                            &process.program,
                            &process.version,
                            &process.commit,
                            &process.configuration,
                            &process.estimator,
                            &process.method,
                            &process.kept,
                            &process.characterisation,
                            &process.realtime,
                            &process.simulation}) {
    *text = next(is_hostile);
  }
  calibration.refused[0] = next(is_hostile);
  return header;
}

/// A record of a newer version may have any code and action.
base::Finding named_finding(bool is_hostile) {
  return {.code = next(is_hostile), .text = next(is_hostile), .action = next(is_hostile)};
}

record::Record named_record(bool is_hostile) {
  record::Record record = test::whole_record();
  record.header = named_header(is_hostile);
  record.events[0].text = next(is_hostile);
  record.end->cause = next(is_hostile);
  record.end->reasons = {next(is_hostile)};
  record.end->results.findings = {named_finding(is_hostile)};
  record.end->results.regime_reason = next(is_hostile);
  analysis::for_each_result(record.end->results,
                            [&](const analysis::ResultName& /*name*/, analysis::Estimate& estimate) {
                              if (!estimate.value) estimate = analysis::Estimate::none(next(is_hostile));
                            });
  return record;
}

Material named_material(bool is_hostile) {
  Material material = test::sample_material();
  material.label = next(is_hostile);
  for (analysis::MeasuredTest& measured : material.measured) {
    measured.results.findings = {named_finding(is_hostile)};
    analysis::for_each_result(measured.results,
                              [&](const analysis::ResultName& /*name*/, analysis::Estimate& estimate) {
                                if (!estimate.value) estimate = analysis::Estimate::none(next(is_hostile));
                              });
  }
  material.groups = analysis::group_by_speed(material.measured);
  for (ReportedTest& reported : material.tests) {
    reported.file = next(is_hostile);
    reported.title = next(is_hostile);
    reported.method = next(is_hostile);
    reported.estimator = next(is_hostile);
  }
  material.tests[2].departures = {next(is_hostile)};
  material.voided = {{next(is_hostile), {next(is_hostile), next(is_hostile), next(is_hostile)}}};
  return material;
}

daemon::Status named_status(bool is_hostile) {
  daemon::Status status;
  status.state = "acquiring";
  status.detail = next(is_hostile);
  status.version = next(is_hostile);
  daq::BoardInfo& board = status.board.emplace();
  board.board_name = next(is_hostile);
  board.device = next(is_hostile);
  board.notes = next(is_hostile);
  status.scheduling = next(is_hostile);
  daemon::TestSummary& test = status.latest_test.emplace();
  test.file = next(is_hostile);
  test.file_error = next(is_hostile);
  test.results.findings = {named_finding(is_hostile)};
  status.storage.why = next(is_hostile);
  status.storage.to_do = next(is_hostile);
  status.storage.lacks = {next(is_hostile)};
  status.calibration.date = next(is_hostile);
  status.calibration.under_way_by = next(is_hostile);
  daemon::BatchProgress& batch = status.batch.emplace();
  batch.id = next(is_hostile);
  batch.name = next(is_hostile);
  batch.trouble = next(is_hostile);
  daemon::FleetState& fleet = status.fleet.emplace();
  fleet.why = next(is_hostile);
  fleet.broker = next(is_hostile);
  fleet.tester = next(is_hostile);
  status.page = daemon::Status::Page{next(is_hostile), next(is_hostile)};
  return status;
}

/// The same lines as with plain words, each of them safe.
void expect_same_lines(std::string_view text, std::string_view plain) {
  expect_safe(text);
  RC_ASSERT(lines_of(text) == lines_of(plain));
}

/// Cells of a line as RFC 4180 cuts it; a quote inside of an unquoted cell is a character.
std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (line[i] == '"' && (quoted || cells.back().empty())) {
      quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

bool is_number(const std::string& cell) {
  char* end = nullptr;
  static_cast<void>(std::strtod(cell.c_str(), &end));
  return !cell.empty() && *end == '\0';
}

/// A spreadsheet cuts lines of comment too, at commas or at semicolons, as its country has it.
void expect_no_formula(std::string_view csv) {
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = std::min(csv.find('\n', begin), csv.size());
    const std::string_view line = csv.substr(begin, end - begin);
    for (const char separator : {',', ';'}) {
      if (separator == ';' && !line.starts_with('#')) continue;
      for (const std::string& cell : cells_of(line, separator)) {
        const std::size_t first = cell.find_first_not_of(' ');
        // RC_ASSERT evaluates both sides of an || of its own.
        const bool is_formula = first != cell.npos &&
                                std::string_view{"=+-@"}.find(cell[first]) != std::string_view::npos &&
                                !is_number(cell);
        RC_ASSERT(!is_formula);
      }
    }
    begin = end + 1;
  }
}

/// With the line ends of RFC 4180 made those of the other outputs.
std::string without_returns(std::string text) {
  for (std::size_t at = text.find("\r\n"); at != text.npos; at = text.find("\r\n", at)) text.erase(at, 1);
  return text;
}

RC_GTEST_PROP(OutputTextProperty, TablesOfScansAndCycles, ()) {
  const record::Record named = named_record(true);
  const record::Record plain = named_record(false);
  for (const auto& table : {io::scans_csv, io::cycles_csv}) {
    const std::string csv = without_returns(table(named));
    expect_same_lines(csv, without_returns(table(plain)));
    expect_no_formula(csv);
  }
}

RC_GTEST_PROP(OutputTextProperty, Tables, ()) {
  using io::Table;
  const auto table_of = [](bool is_hostile) {
    Table table{{{.name = next(is_hostile), .heading = next(is_hostile), .align = Table::Align::kLeft},
                 {.name = next(is_hostile), .heading = next(is_hostile), .unit = next(is_hostile)}}};
    for (int row = 0; row < 3; ++row) table.add({next(is_hostile), next(is_hostile)});
    return table;
  };
  const Table named = table_of(true);
  const Table plain = table_of(false);
  expect_same_lines(named.text(), plain.text());
  const std::string csv = without_returns(named.csv());
  expect_same_lines(csv, without_returns(plain.csv()));
  expect_no_formula(csv);
  RC_ASSERT(named.json().size() == plain.json().size());
}

plot::Figure named_figure(bool is_hostile) {
  plot::Figure figure;
  figure.title = next(is_hostile);
  figure.x.label = next(is_hostile);
  figure.notes = {next(is_hostile), next(is_hostile)};
  plot::Panel& panel = figure.panels.emplace_back();
  panel.y.label = next(is_hostile);
  panel.curves = {{.label = next(is_hostile), .x = {0.0, 1.0}, .y = {0.3, 0.35}}};
  panel.markers = {{0.5, 0.3, next(is_hostile)}};
  return figure;
}

// gnuplot draws what stands between single quotes literally; a quote among it is written twice.
RC_GTEST_PROP(OutputTextProperty, PicturesAsGnuplotIsToldThem, ()) {
  const std::string script = plot::gnuplot_script(named_figure(true), plot::PictureFormat::kSvg);
  expect_same_lines(script, plot::gnuplot_script(named_figure(false), plot::PictureFormat::kSvg));
  for (std::size_t begin = 0; begin < script.size(); begin = script.find('\n', begin) + 1) {
    const std::string line = script.substr(begin, script.find('\n', begin) - begin);
    RC_ASSERT(std::count(line.begin(), line.end(), '\'') % 2 == 0);
    if (script.find('\n', begin) == script.npos) break;
  }
}

RC_GTEST_PROP(OutputTextProperty, ReportAsTextTableAndPage, ()) {
  const Material named = named_material(true);
  const Material plain = named_material(false);
  expect_safe(report_text(named));
  const MaterialComparison compared = compare_materials(named, plain);
  expect_safe(comparison_text(named, plain, compared));
  const std::string csv = without_returns(report_csv(named));
  expect_same_lines(csv, without_returns(report_csv(plain)));
  expect_no_formula(csv);
  expect_no_formula(without_returns(comparison_csv(named, plain, compared)));
  const std::string page = report_page(named, {});
  const std::string plain_page = report_page(plain, {});
  RC_ASSERT(base::is_utf8(page));
  RC_ASSERT(lines_of(page) == lines_of(plain_page));
  RC_ASSERT(std::count(page.begin(), page.end(), '<') ==
            std::count(plain_page.begin(), plain_page.end(), '<'));
}

RC_GTEST_PROP(OutputTextProperty, MetricsFramesAndMessages, ()) {
  const daemon::Status named = named_status(true);
  const daemon::Status plain = named_status(false);
  expect_same_lines(control::metrics_text(named), control::metrics_text(plain));
  const std::string tester = *hostile();
  const record::Record record = named_record(true);
  const auto result = fleet::result_json(record.header, *record.end, record.cycles, *hostile());
  for (const std::string& message : {daemon::health_frame(named), fleet::state_message(tester, named, 0),
                                     fleet::health_message(tester, named, 0), fleet::last_will(tester, 0),
                                     fleet::result_message(tester, result)}) {
    expect_safe(message);
    RC_ASSERT(lines_of(message) == 0);
    RC_ASSERT(nlohmann::json::accept(message));
  }
}

RC_GTEST_PROP(OutputTextProperty, VerdictsOfFilesAndOfWhatTheyHold, ()) {
  const test::TemporaryFolder folder;
  std::string name = *hostile();
  name.erase(std::remove(name.begin(), name.end(), '\0'), name.end());
  const std::string journal = (folder / "a.journal").string();
  test::write_journal(journal, named_record(true));
  test::write_journal((folder / "b.journal"), named_record(false));
  const std::string nowhere = folder.path() / ("no" + name);
  const std::string plain =
      io::verify_files({(folder / "b.journal").string(), folder.path() / "none"}, false).text;
  expect_same_lines(io::verify_files({journal, nowhere}, false).text, plain);
  const std::string json = io::verify_files({journal, nowhere}, true).text;
  expect_safe(json);
  RC_ASSERT(nlohmann::json::accept(json));
}

}  // namespace
}  // namespace stickslip::report
