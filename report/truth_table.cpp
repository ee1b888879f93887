#include "report/truth_table.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "io/table.hpp"
#include "report/ramp_text.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

using analysis::Estimate;
using analysis::TestResults;
using model::TestTruth;

struct Column {
  std::string_view title;
  std::size_t width;
  std::string_view format;
  const Estimate TestResults::*measured;
  std::optional<double> (*truth)(const TestTruth&);
};

constexpr std::array<Column, 8> kColumns{{
    {"static", 7, ".4f", &TestResults::static_coefficient,
     [](const TestTruth& t) { return t.static_coefficient; }},
    {"kinetic", 7, ".4f", &TestResults::kinetic_coefficient,
     [](const TestTruth& t) { return t.kinetic_coefficient; }},
    {"S", 7, ".4f", &TestResults::mu_s, [](const TestTruth& t) -> std::optional<double> { return t.mu_s; }},
    {"K", 7, ".4f", &TestResults::mu_k, [](const TestTruth& t) -> std::optional<double> { return t.mu_k; }},
    {"S−K", 7, ".4f", &TestResults::delta_mu,
     [](const TestTruth& t) -> std::optional<double> { return t.mu_s - t.mu_k; }},
    {"f (Hz)", 7, ".3f", &TestResults::oscillation_frequency,
     [](const TestTruth& t) { return t.oscillation_frequency_Hz; }},
    {"amplitude", 9, ".4f", &TestResults::amplitude, [](const TestTruth& t) { return t.amplitude; }},
    {"γ/2ω", 7, ".5f", &TestResults::gamma_over_2omega,
     [](const TestTruth& t) -> std::optional<double> { return t.gamma_over_2omega; }},
}};

io::Table table_without_rows() {
  using enum io::Table::Align;
  std::vector<io::Table::Column> columns{{.heading = "test"},
                                         {.heading = "", .align = kLeft, .width = 8},
                                         {.heading = "regime", .align = kLeft, .width = 14}};
  for (const Column& column : kColumns) {
    columns.push_back(
        {.heading = std::string{column.title}, .format = std::string{column.format}, .width = column.width});
  }
  columns.push_back({.heading = "file, scene", .align = kLeft});
  return io::Table{std::move(columns)};
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
  io::Table table = table_without_rows();
  for (const TableRow& row : rows) {
    std::vector<io::Table::Cell> cells{row.number, row.truth ? "measured" : "",
                                       io::cell(model::name(row.results.regime))};
    for (const Column& column : kColumns) cells.push_back(io::cell((row.results.*column.measured).value));
    cells.emplace_back(row.where);
    table.add(std::move(cells));
    if (!row.truth) continue;
    cells = {"", "truth", io::cell(model::name(row.truth->regime))};
    for (const Column& column : kColumns) cells.push_back(io::cell(column.truth(*row.truth)));
    cells.emplace_back(row.truth->scene_name);
    table.add(std::move(cells));
  }
  std::string text = table.text();
  std::string findings;
  for (const TableRow& row : rows) {
    for (const std::string& finding : row.results.findings) {
      findings += fmt::format("!  test {}: {}\n", row.number, base::printable(finding));
    }
    if (const std::string ramp = ramp_text(row.results); !ramp.empty())
      text += fmt::format("ramp, test {}: {}\n", row.number, ramp);
  }
  return text + footnotes(rows) + findings;
}

}  // namespace stickslip::report
