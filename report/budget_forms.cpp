#include "report/budget_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/or_null.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include "report/wrapped.hpp"
#include <nlohmann/json.hpp>

#include "core/base/digits.hpp"
#include "core/base/text.hpp"
#include "core/daq/calibration.hpp"
#include "core/record/method_text.hpp"

namespace stickslip::report {
namespace {

using analysis::BudgetLine;
using analysis::BudgetState;
using analysis::Quantity;
using analysis::UncertaintyBudget;

const Quantity& quantity_at(std::size_t i) { return analysis::quantities()[analysis::kBudgetQuantities[i]]; }

/// Two significant digits, at most six decimals.
std::string size_text(double size) {
  constexpr int kMost = 6;
  constexpr double kLeast = 1e-6;
  if (!std::isfinite(size)) return "∞";
  if (!(size > 0.0)) return "0";
  if (size < kLeast) return "<1e-6";
  return fmt::format("{:.{}f}", size,
                     std::clamp(base::decimals_of(size, base::kUncertaintyDigits), 0, kMost));
}

std::string cell_text(const BudgetLine& line) {
  switch (line.state) {
    case BudgetState::kCounted:
      return size_text(line.size.value_or(0.0));
    case BudgetState::kIncluded:
      return line.size ? fmt::format("({})", size_text(*line.size)) : "( )";
    case BudgetState::kNone:
      return "0";
    case BudgetState::kUnknown:
      break;
  }
  return std::string{io::kAbsent};
}

std::string share_text(double share) {
  const double percent = 100.0 * share;
  if (percent > 0.0 && percent < 0.5) return "<1";
  return fmt::format("{:.0f}", percent);
}

const BudgetLine* line_of(const std::optional<UncertaintyBudget>& budget, std::string_view source) {
  if (!budget) return nullptr;
  const auto found =
      std::ranges::find_if(budget->lines, [&](const BudgetLine& line) { return line.source == source; });
  return found == budget->lines.end() ? nullptr : &*found;
}

/// The sources of all budgets, each once, in the order of their first budget.
std::vector<const BudgetLine*> sources_of(const Budgets& budgets) {
  std::vector<const BudgetLine*> sources;
  for (const auto& budget : budgets) {
    if (!budget) continue;
    for (const BudgetLine& line : budget->lines) {
      if (std::ranges::none_of(sources,
                               [&](const BudgetLine* other) { return other->source == line.source; }))
        sources.push_back(&line);
    }
  }
  return sources;
}

/// A row of a number of each budget, below "size".
std::vector<io::Table::Cell> sum_row(std::string title, const Budgets& budgets, double factor) {
  std::vector<io::Table::Cell> cells{std::move(title), ""};
  for (const auto& budget : budgets) {
    const bool is_known = budget && budget->combined;
    cells.emplace_back(is_known ? size_text(factor * *budget->combined)
                                : std::string{budget ? io::kAbsent : ""});
    cells.emplace_back(is_known && factor == 1.0 ? "100" : "");
  }
  return cells;
}

/// What is not known ("–") or counts with a reserve ("!"), each note once, with the quantities that it is of.
std::string note_lines(const Budgets& budgets) {
  struct Note {
    std::string text;
    std::string quantities;
  };
  std::vector<Note> notes;
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    if (!budgets[i]) continue;
    for (const BudgetLine& line : budgets[i]->lines) {
      const bool is_unknown = line.state == BudgetState::kUnknown;
      if (line.note.empty() || !(is_unknown || line.state == BudgetState::kCounted)) continue;
      std::string text = fmt::format("{}  {}: {}", is_unknown ? io::kAbsent : "!", line.title, line.note);
      const auto found = std::ranges::find(notes, text, &Note::text);
      if (found == notes.end()) {
        notes.push_back({std::move(text), std::string{quantity_at(i).title}});
      } else {
        found->quantities += fmt::format(", {}", quantity_at(i).title);
      }
    }
  }
  constexpr std::size_t kIndent = 3;
  std::string lines;
  for (const Note& note : notes)
    lines += wrapped(fmt::format("{} ({})", base::printable(note.text), note.quantities), kIndent) + "\n";
  return lines;
}

}  // namespace

analysis::BudgetFacts budget_facts_of(const record::RecordHeader& header) {
  analysis::BudgetFacts facts;
  facts.pull_speed_m_per_s = header.tester.pull_speed_m_per_s;
  if (base::Result<model::Method> method = record::method_from_text(header.process.method))
    facts.method = *std::move(method);
  try {
    const daq::Calibration calibration{header.board, header.load_cell.value_or(daq::LoadCell{}),
                                       header.tester.tester().normal_load_N()};
    if (calibration.step_coefficient() > 0.0) facts.step_coefficient = calibration.step_coefficient();
  } catch (const std::invalid_argument&) {
    // A file may hold anything: the step is not known.
  }
  return facts;
}

Budgets budgets_of(const analysis::TestResults& results, const analysis::BudgetFacts& facts) {
  Budgets budgets;
  for (std::size_t i = 0; i < budgets.size(); ++i)
    budgets[i] = analysis::test_budget(results, quantity_at(i), facts);
  return budgets;
}

Budgets budgets_of(std::span<const analysis::MeasuredTest> tests, const analysis::SpeedGroup& group) {
  Budgets budgets;
  for (std::size_t i = 0; i < budgets.size(); ++i)
    budgets[i] = analysis::group_budget(tests, group, analysis::kBudgetQuantities[i]);
  return budgets;
}

std::string statement_of(const Quantity& quantity, const UncertaintyBudget& budget) {
  const std::string unknown = budget.unknown();
  const std::optional<double> expanded = budget.expanded();
  const int decimals = io::decimals_for(expanded, quantity.decimals);
  std::string text = fmt::format("{} = {:.{}f}", quantity.title, budget.value, decimals);
  if (!expanded) return text + fmt::format(", uncertainty not known: {}", unknown);
  analysis::Estimate with_error = analysis::Estimate::of(budget.value);
  with_error.standard_error = expanded;
  text += fmt::format(" ± {} (k = {:g})", io::uncertain(with_error, quantity.decimals).standard_error,
                      analysis::kCoverageFactor);
  if (!unknown.empty()) text += fmt::format(", without {}", unknown);
  if (budget.coverage)
    text += fmt::format("; so few tests that it covers {:.0f} %, not 95 %", 100.0 * *budget.coverage);
  return text;
}

std::string budget_text(const Budgets& budgets) {
  using enum io::Table::Align;
  const std::vector<const BudgetLine*> sources = sources_of(budgets);
  if (sources.empty()) return {};
  std::vector<io::Table::Column> columns{{.heading = "", .align = kLeft, .width = 21},
                                         {.heading = "type", .align = kLeft}};
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    columns.push_back({.heading = fmt::format("u {}", quantity_at(i).title), .width = 10});
    columns.push_back({.heading = "%", .width = 3});
  }
  io::Table table{std::move(columns)};
  for (const BudgetLine* const source : sources) {
    std::vector<io::Table::Cell> cells{io::cell(source->title), std::string{source->type}};
    for (const auto& budget : budgets) {
      const BudgetLine* const line = line_of(budget, source->source);
      cells.emplace_back(line == nullptr ? std::string{} : cell_text(*line));
      cells.emplace_back(line != nullptr && line->state == BudgetState::kCounted
                             ? share_text(budget->share_of(*line))
                             : std::string{});
    }
    table.add(std::move(cells));
  }
  table.add(sum_row("combined, u", budgets, 1.0));
  table.add(sum_row("expanded, U = 2 u", budgets, analysis::kCoverageFactor));
  std::string text = table.text();
  constexpr std::size_t kIndent = 3;
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    if (budgets[i]) text += wrapped(statement_of(quantity_at(i), *budgets[i]), kIndent) + "\n";
  }
  text += note_lines(budgets);
  return text + "u: standard uncertainty; %: of u²; A by statistics, B else; ( ) in another line\n";
}

nlohmann::ordered_json budgets_json(const Budgets& budgets) {
  using Json = nlohmann::ordered_json;
  Json json = Json::object();
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    const Quantity& quantity = quantity_at(i);
    Json& own = json[std::string{quantity.name}];
    if (!budgets[i]) continue;
    const UncertaintyBudget& budget = *budgets[i];
    own = {{"value", budget.value}, {"lines", Json::array()}};
    for (const BudgetLine& line : budget.lines) {
      Json of_line{
          {"source", line.source},
          {"title", line.title},
          {"type", std::string{line.type}},
          {"state", analysis::name(line.state)},
          {"standard_uncertainty", io::or_null(line.size)},
          {"share", line.state == BudgetState::kCounted ? Json(budget.share_of(line)) : Json(nullptr)}};
      if (!line.note.empty()) of_line["note"] = line.note;
      own["lines"].push_back(std::move(of_line));
    }
    own["combined_standard_uncertainty"] = io::or_null(budget.combined);
    own["expanded_uncertainty"] = io::or_null(budget.expanded());
    own["coverage_factor"] = analysis::kCoverageFactor;
    own["coverage"] = io::or_null(budget.coverage);
    own["statement"] = statement_of(quantity, budget);
  }
  return json;
}

}  // namespace stickslip::report
