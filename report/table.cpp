#include "report/table.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "report/ramp_text.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

using analysis::Estimate;
using analysis::TestResults;
using model::TestTruth;

constexpr std::string_view kAbsent = "–";

struct Column {
  std::string_view title;
  int width;
  int decimals;
  const Estimate TestResults::*measured;
  std::optional<double> (*truth)(const TestTruth&);
};

constexpr std::array<Column, 8> kColumns{{
    {"static", 7, 4, &TestResults::static_coefficient,
     [](const TestTruth& t) { return t.static_coefficient; }},
    {"kinetic", 7, 4, &TestResults::kinetic_coefficient,
     [](const TestTruth& t) { return t.kinetic_coefficient; }},
    {"S", 7, 4, &TestResults::mu_s, [](const TestTruth& t) -> std::optional<double> { return t.mu_s; }},
    {"K", 7, 4, &TestResults::mu_k, [](const TestTruth& t) -> std::optional<double> { return t.mu_k; }},
    {"S−K", 7, 4, &TestResults::delta_mu,
     [](const TestTruth& t) -> std::optional<double> { return t.mu_s - t.mu_k; }},
    {"f (Hz)", 7, 3, &TestResults::oscillation_frequency,
     [](const TestTruth& t) { return t.oscillation_frequency_Hz; }},
    {"amplitude", 9, 4, &TestResults::amplitude, [](const TestTruth& t) { return t.amplitude; }},
    {"γ/2ω", 7, 5, &TestResults::gamma_over_2omega,
     [](const TestTruth& t) -> std::optional<double> { return t.gamma_over_2omega; }},
}};

constexpr int kRegimeWidth = 14;

std::string cell(const std::optional<double>& value, const Column& column) {
  return value ? fmt::format("{:.{}f}", *value, column.decimals) : std::string{kAbsent};
}

std::string line(std::string_view number, std::string_view kind, std::string_view regime,
                 const std::array<std::string, kColumns.size()>& cells, std::string_view where) {
  std::string text = fmt::format("{:>4}  {:<8}  {:<{}}", number, kind, regime, kRegimeWidth);
  for (std::size_t i = 0; i < kColumns.size(); ++i)
    text += fmt::format("  {:>{}}", cells[i], kColumns[i].width);
  return fmt::format("{}  {}\n", text, base::printable(where));
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
    text += fmt::format("{}  no {} in test {}: {}\n", kAbsent, kColumns[key.first].title, tests,
                        base::printable(key.second));
  }
  return text;
}

}  // namespace

std::string format_table(std::span<const TableRow> rows) {
  std::array<std::string, kColumns.size()> cells;
  for (std::size_t i = 0; i < kColumns.size(); ++i) cells[i] = kColumns[i].title;
  std::string text = line("test", "", "regime", cells, "file, scene");
  std::string findings;
  for (const TableRow& row : rows) {
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      cells[i] = cell((row.results.*kColumns[i].measured).value, kColumns[i]);
    }
    text += line(fmt::format("{}", row.number), row.truth ? "measured" : "", model::name(row.results.regime),
                 cells, row.where);
    if (!row.truth) continue;
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      cells[i] = cell(kColumns[i].truth(*row.truth), kColumns[i]);
    }
    text += line("", "truth", model::name(row.truth->regime), cells, row.truth->scene_name);
  }
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
