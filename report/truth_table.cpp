#include "report/truth_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "io/findings_text.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include "report/ramp_text.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

using analysis::Estimate;
using analysis::TestResults;
using model::TestTruth;

struct Column {
  std::string_view title;
  const Estimate TestResults::*measured;
  std::optional<double> (*truth)(const TestTruth&);
};

/// With the errors below them they fit a terminal of 80 columns; `stickslip show` has all results.
constexpr std::array<Column, 5> kColumns{{
    {"S−K", &TestResults::delta_mu,
     [](const TestTruth& t) -> std::optional<double> { return t.mu_s - t.mu_k; }},
    {"S", &TestResults::mu_s, [](const TestTruth& t) -> std::optional<double> { return t.mu_s; }},
    {"K", &TestResults::mu_k, [](const TestTruth& t) -> std::optional<double> { return t.mu_k; }},
    {"static", &TestResults::static_coefficient, [](const TestTruth& t) { return t.static_coefficient; }},
    {"kinetic", &TestResults::kinetic_coefficient, [](const TestTruth& t) { return t.kinetic_coefficient; }},
}};
constexpr int kDecimals = 4;

constexpr std::string_view kStandardErrorRow = "± stat.";
constexpr std::string_view kSystematicRow = "± syst.";
constexpr std::string_view kTruthRow = "truth";

/// One line of the table before it is padded.
struct Line {
  io::Table::Cell number;
  std::string label;
  std::array<std::string, kColumns.size()> numbers;
  std::string where;
};

using Part = std::string io::Uncertain::*;
using Numbers = std::array<io::Uncertain, kColumns.size()>;

bool any(const Numbers& numbers, Part part) {
  return std::any_of(numbers.begin(), numbers.end(),
                     [part](const io::Uncertain& number) { return !(number.*part).empty(); });
}

Line line_of(const Numbers& numbers, Part part, io::Table::Cell number, std::string_view label,
             std::string where) {
  Line line{std::move(number), std::string{label}, {}, std::move(where)};
  for (std::size_t c = 0; c < kColumns.size(); ++c) line.numbers[c] = numbers[c].*part;
  return line;
}

Numbers measured_numbers(const TestResults& results) {
  Numbers numbers;
  for (std::size_t c = 0; c < kColumns.size(); ++c)
    numbers[c] = io::uncertain(results.*kColumns[c].measured, kDecimals);
  return numbers;
}

Numbers true_numbers(const TestTruth& truth) {
  Numbers numbers;
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    const std::optional<double> value = kColumns[c].truth(truth);
    numbers[c] = io::uncertain(value ? Estimate::of(*value) : Estimate{}, kDecimals);
  }
  return numbers;
}

/// Blanks behind the numbers of a column put their decimal points one below the other.
void align_points(std::vector<Line>& lines, std::size_t column) {
  const auto behind = [column](const Line& line) {
    const std::string& text = line.numbers[column];
    const std::size_t point = text.find('.');
    return point == std::string::npos ? std::size_t{0} : text.size() - point;
  };
  std::size_t most = 0;
  for (const Line& line : lines) most = std::max(most, behind(line));
  for (Line& line : lines) {
    std::string& text = line.numbers[column];
    if (!text.empty() && text != io::kAbsent) text.append(most - behind(line), ' ');
  }
}

constexpr std::size_t kTerminalWidth = 80;

bool fits(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (io::display_width(std::string_view{text}.substr(at, end - at)) > kTerminalWidth) return false;
    at = end + 1;
  }
  return true;
}

std::string table_text(const std::vector<Line>& lines, bool with_where) {
  using enum io::Table::Align;
  std::vector<io::Table::Column> columns{{.heading = "test"}, {.heading = "regime", .align = kLeft}};
  for (const Column& column : kColumns) columns.push_back({.heading = std::string{column.title}});
  if (with_where) columns.push_back({.heading = "file, scene", .align = kLeft});
  io::Table table{std::move(columns)};
  for (const Line& line : lines) {
    std::vector<io::Table::Cell> cells{line.number, line.label};
    for (const std::string& number : line.numbers) cells.emplace_back(number);
    if (with_where) cells.emplace_back(line.where);
    table.add(std::move(cells));
  }
  return table.text();
}

/// Files and scenes below the table: "file of test 3: records/3.h5", "truth of test 1, 2: ring-down".
std::string places(std::span<const TableRow> rows) {
  std::string text;
  std::vector<std::pair<std::string, std::string>> scenes;  // With the tests.
  for (const TableRow& row : rows) {
    text += fmt::format("file of test {}: {}\n", row.number, base::printable(row.where));
    if (!row.truth) continue;
    auto found = std::find_if(scenes.begin(), scenes.end(),
                              [&row](const auto& scene) { return scene.first == row.truth->scene_name; });
    if (found == scenes.end()) found = scenes.insert(scenes.end(), {row.truth->scene_name, ""});
    found->second += fmt::format("{}{}", found->second.empty() ? "" : ", ", row.number);
  }
  for (const auto& [scene, tests] : scenes)
    text += fmt::format("scene of test {}: {}\n", tests, base::printable(scene));
  return text;
}

/// At most 80 columns wide: files and scenes stand behind the numbers where there is room, else below.
std::string table_text(std::vector<Line> lines, std::span<const TableRow> rows) {
  for (std::size_t c = 0; c < kColumns.size(); ++c) align_points(lines, c);
  std::string text = table_text(lines, true);
  return fits(text) ? text : table_text(lines, false) + places(rows);
}

/// What the rows of errors mean.
std::string legend(const std::vector<Line>& lines) {
  const auto has = [&lines](std::string_view label) {
    return std::any_of(lines.begin(), lines.end(), [label](const Line& line) { return line.label == label; });
  };
  std::string text;
  if (has(kStandardErrorRow))
    text += fmt::format("{}  standard error: less with more slips or more tests\n", kStandardErrorRow);
  if (has(kSystematicRow)) {
    text +=
        fmt::format("{}  systematic part (calibration, corrections): the same each time\n", kSystematicRow);
  }
  if (std::any_of(lines.begin(), lines.end(), [](const Line& line) {
        const auto* const number = std::get_if<std::string>(&line.number);
        return number != nullptr && *number == kTruthRow;
      }))
    text += fmt::format("{}    what was simulated\n", kTruthRow);
  return text;
}

/// Which numbers are not significant: "S−K in test 3, 4; K in test 4".
std::string not_significant(std::span<const TableRow> rows) {
  std::string which;
  for (const Column& column : kColumns) {
    std::string tests;
    for (const TableRow& row : rows) {
      if (io::uncertain(row.results.*column.measured, kDecimals).significant) continue;
      tests += fmt::format("{}{}", tests.empty() ? "" : ", ", row.number);
    }
    if (!tests.empty())
      which += fmt::format("{}{} in test {}", which.empty() ? "" : "; ", column.title, tests);
  }
  return which.empty() ? which : fmt::format("{}: {}\n", io::kNotSignificantLegend, which);
}

/// Why numbers are absent, each reason once with the tests it concerns.
std::string footnotes(std::span<const TableRow> rows) {
  std::map<std::pair<std::size_t, std::string>, std::string> tests_of;
  for (const TableRow& row : rows) {
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const Estimate& estimate = row.results.*kColumns[i].measured;
      if (estimate.value || estimate.reason.empty()) continue;
      std::string& tests = tests_of[{i, estimate.reason}];
      tests += fmt::format("{}{}", tests.empty() ? "" : ", ", row.number);
    }
  }
  std::string text;
  for (const auto& [key, tests] : tests_of) {
    text += fmt::format("{}  no {} in test {}: {}\n", io::kAbsent, kColumns[key.first].title, tests,
                        base::printable(key.second));
  }
  return text;
}

}  // namespace

std::string format_table(std::span<const TableRow> rows) {
  std::vector<Line> lines;
  for (const TableRow& row : rows) {
    const Numbers measured = measured_numbers(row.results);
    lines.push_back(
        line_of(measured, &io::Uncertain::value, row.number, model::name(row.results.regime), row.where));
    for (const auto& [part, label] : {std::pair{&io::Uncertain::standard_error, kStandardErrorRow},
                                      std::pair{&io::Uncertain::systematic, kSystematicRow}}) {
      if (any(measured, part)) lines.push_back(line_of(measured, part, "", label, ""));
    }
    if (row.truth) {
      lines.push_back(line_of(true_numbers(*row.truth), &io::Uncertain::value, std::string{kTruthRow},
                              model::name(row.truth->regime), row.truth->scene_name));
    }
  }
  std::string text = table_text(lines, rows) + legend(lines);
  std::vector<io::TestFindings> findings;
  for (const TableRow& row : rows) {
    findings.push_back({row.number, row.results.findings});
    if (const std::string ramp = ramp_text(row.results); !ramp.empty())
      text += fmt::format("ramp, test {}: {}\n", row.number, ramp);
  }
  return text + not_significant(rows) + footnotes(rows) + io::findings_text(findings);
}

}  // namespace stickslip::report
