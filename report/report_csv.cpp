#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/table.hpp"
#include "report/budget_forms.hpp"
#include "report/report_json.hpp"

#include "core/analysis/results.hpp"

namespace stickslip::report {
namespace {

using Cells = std::vector<io::Table::Cell>;

template <typename... T>
void add(Cells& cells, const T&... values) {
  (cells.push_back(io::cell(values)), ...);
}

void add_interval(Cells& cells, const std::optional<analysis::Interval>& value) {
  add(cells, value ? std::optional{value->low} : std::nullopt,
      value ? std::optional{value->high} : std::nullopt);
}

bool is_quantity(std::string_view name) {
  const auto& all = analysis::quantities();
  return std::any_of(all.begin(), all.end(),
                     [name](const analysis::Quantity& quantity) { return quantity.name == name; });
}

io::Table table_of(const std::vector<std::string>& names) {
  std::vector<io::Table::Column> columns;
  for (const std::string& name : names) columns.push_back({.name = name});
  return io::Table{std::move(columns)};
}

/// Keys of the facts that any test states.
std::set<std::string> keys_of(const Material& material) {
  std::set<std::string> keys;
  for (const ReportedTest& test : material.tests) {
    for (const auto& [key, value] : test.sample.metadata) keys.insert(key);
  }
  return keys;
}

/// Those of the known facts that have numbers.
std::vector<const record::KnownFact*> numbers_of(const std::set<std::string>& keys) {
  std::vector<const record::KnownFact*> facts;
  for (const record::KnownFact& fact : record::known_facts()) {
    if (!fact.unit.empty() && keys.contains(std::string{fact.key})) facts.push_back(&fact);
  }
  return facts;
}

/// One side of a comparison.
void summary_cells(Cells& cells, const Material& material, const std::optional<std::size_t>& group,
                   std::size_t q) {
  const analysis::GroupQuantity* own = group ? &material.groups[*group].quantities[q] : nullptr;
  const analysis::Replicates none;
  const bool has = own != nullptr && own->replicates;
  const analysis::Replicates& replicates = has ? *own->replicates : none;
  add(cells, replicates.count, has ? std::optional{replicates.mean} : std::nullopt,
      replicates.standard_deviation, replicates.repeatability);
  add_interval(cells, replicates.mean_interval);
}

/// The same of S − K by cycle, whose scatter is not one of single tests.
void by_cycle_cells(Cells& cells, const Material& material, const std::optional<std::size_t>& group) {
  const analysis::PooledDeltaMu none;
  const analysis::PooledDeltaMu& pooled = group ? material.groups[*group].by_cycle : none;
  add(cells, pooled.test_count, pooled.mean.value, "", "");
  add_interval(cells, analysis::mean_interval(pooled));
}

void welch_cells(Cells& cells, const std::optional<analysis::Welch>& welch) {
  if (!welch) return cells.resize(cells.size() + 6);
  add(cells, welch->difference);
  add_interval(cells, welch->interval);
  add(cells, welch->t, welch->degrees_of_freedom, welch->p);
}

}  // namespace

std::string report_csv(const Material& material) {
  std::vector<std::string> names{"file", "title", "method", "estimator", "pull_speed", "regime", "rung"};
  const analysis::TestResults none;
  analysis::for_each_result(none, [&](const analysis::ResultName& name, const analysis::Estimate&) {
    if (!name.is_diagnostic) names.emplace_back(name.name);
  });
  for (const char* name : {"at_speed_delta_mu_by_cycle", "at_speed_delta_mu_by_cycle_standard_error",
                           "at_speed_slips", "at_speed_escaped", "absent", "voided"}) {
    names.emplace_back(name);
  }
  const std::size_t voided_column = names.size() - 1;
  // Behind all others: a reader that counts columns finds them where they were.
  for (const analysis::Quantity& quantity : analysis::quantities()) {
    names.push_back(fmt::format("{}_standard_error", quantity.name));
    names.push_back(fmt::format("{}_systematic_uncertainty", quantity.name));
  }
  names.emplace_back("at_speed_delta_mu_by_cycle_systematic_uncertainty");
  names.emplace_back("findings");
  for (const char* name : {"date", "sample", "grade", "operator", "batch"}) names.emplace_back(name);
  analysis::for_each_result(none, [&](const analysis::ResultName& name, const analysis::Estimate&) {
    if (!name.is_diagnostic && !is_quantity(name.name))
      names.push_back(fmt::format("{}_standard_error", name.name));
  });
  for (const std::size_t q : analysis::kBudgetQuantities)
    names.push_back(fmt::format("{}_expanded_uncertainty", analysis::quantities()[q].name));
  const std::set<std::string> keys = keys_of(material);
  for (const std::string& key : keys) names.push_back("fact." + key);
  for (const record::KnownFact* fact : numbers_of(keys))
    names.push_back(fmt::format("{}_{}", fact->key, fact->unit == "1" ? "ratio" : fact->unit));
  io::Table table = table_of(names);
  std::vector<const analysis::PooledDeltaMu*> by_cycle(material.tests.size());
  for (const analysis::SpeedGroup& group : material.groups) {
    for (const std::size_t test : group.tests) by_cycle[test] = &group.by_cycle;
  }
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    const analysis::MeasuredTest& measured = material.measured[i];
    const ReportedTest& test = material.tests[i];
    Cells cells;
    add(cells, test.file, test.title, test.method, test.estimator, measured.pull_speed_m_per_s,
        model::name(measured.results.regime), analysis::name(measured.results.rung));
    std::string reasons;
    analysis::for_each_result(
        measured.results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
          if (name.is_diagnostic) return;
          add(cells, estimate.value);
          if (!estimate.value) {
            reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", name.name, estimate.reason);
          }
        });
    const analysis::PooledDeltaMu& pooled = *by_cycle[i];
    add(cells, pooled.mean.value, pooled.mean.standard_error, pooled.slip_count, pooled.escaped_count,
        reasons, "");
    for (const analysis::Quantity& quantity : analysis::quantities()) {
      const analysis::Estimate& estimate = measured.results.*quantity.estimate;
      add(cells, estimate.standard_error, estimate.systematic_uncertainty);
    }
    std::string findings;
    for (const base::Finding& finding : measured.results.findings)
      findings += fmt::format("{}{}: {}", findings.empty() ? "" : "; ", finding.code, finding.text);
    add(cells, pooled.mean.systematic_uncertainty, findings, test.start_time, test.sample.name,
        test.sample.grade, test.sample.operator_name, test.sample.batch);
    analysis::for_each_result(measured.results,
                              [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                                if (!name.is_diagnostic && !is_quantity(name.name))
                                  add(cells, estimate.standard_error);
                              });
    for (const auto& budget : budgets_of(measured.results, measured.budget_facts))
      add(cells, budget ? budget->expanded() : std::nullopt);
    const auto stated = [&](std::string_view key) {
      const auto found = test.sample.metadata.find(key);
      return found == test.sample.metadata.end() ? std::string{} : found->second;
    };
    for (const std::string& key : keys) add(cells, stated(key));
    for (const record::KnownFact* fact : numbers_of(keys)) {
      const auto number = record::fact_number(fact->key, stated(fact->key));
      add(cells, number ? std::optional{*number} : std::nullopt);
    }
    table.add(std::move(cells));
  }
  // No numbers, so that nobody averages them.
  for (const VoidedTest& test : material.voided) {
    Cells cells(names.size());
    cells.front() = test.file;
    cells[voided_column] = test.voiding.reason;
    table.add(std::move(cells));
  }
  return table.csv();
}

std::string comparison_csv(const Material& a, const Material& b, const MaterialComparison& comparison) {
  std::vector<std::string> names{"pull_speed", "quantity", "unit"};
  for (const char* side : {"a", "b"}) {
    for (const char* name :
         {"count", "mean", "standard_deviation", "repeatability", "mean_low", "mean_high"}) {
      names.push_back(fmt::format("{}_{}", side, name));
    }
  }
  for (const char* name :
       {"difference", "difference_low", "difference_high", "t", "degrees_of_freedom", "p", "hedges_g",
        "hedges_g_low", "hedges_g_high", "tests_needed_80", "tests_needed_90", "reason"}) {
    names.emplace_back(name);
  }
  io::Table table = table_of(names);
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const analysis::SpeedPair& pair = comparison.pairs[i];
    Cells by_cycle;
    add(by_cycle, pair.pull_speed_m_per_s, "delta_mu_by_cycle", "1");
    by_cycle_cells(by_cycle, a, pair.a);
    by_cycle_cells(by_cycle, b, pair.b);
    welch_cells(by_cycle, comparison.by_cycle[i].welch);
    by_cycle.resize(names.size());  // No g, no number of tests.
    by_cycle.back() = comparison.by_cycle[i].reason;
    table.add(std::move(by_cycle));
    for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
      const analysis::Quantity& quantity = analysis::quantities()[q];
      const auto& [welch, effect, needed, reason] = comparison.comparisons[i][q];
      Cells cells;
      add(cells, pair.pull_speed_m_per_s, quantity.name, quantity.unit);
      summary_cells(cells, a, pair.a, q);
      summary_cells(cells, b, pair.b, q);
      welch_cells(cells, welch);
      add(cells, effect ? std::optional{effect->g} : std::nullopt);
      add_interval(cells, effect ? effect->interval : std::nullopt);
      add(cells, needed ? needed->for_80_percent : std::nullopt,
          needed ? needed->for_90_percent : std::nullopt, reason);
      table.add(std::move(cells));
    }
  }
  return table.csv();
}

}  // namespace stickslip::report
