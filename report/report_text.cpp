#include "report/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/table.hpp"
#include "io/uncertain.hpp"
#include "report/budget_forms.hpp"
#include "report/truth_table.hpp"
#include "report/wrapped.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

using analysis::GroupQuantity;
using analysis::Interval;
using analysis::Quantity;
using analysis::Replicates;
using analysis::SpeedGroup;

std::string number(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string{io::kAbsent};
}

std::string interval(const std::optional<Interval>& value, int decimals) {
  return value ? fmt::format("{:.{}f} … {:.{}f}", value->low, decimals, value->high, decimals)
               : std::string{io::kAbsent};
}

double half_of(const Interval& value) { return 0.5 * (value.high - value.low); }

/// Decimals of a mean: they follow half of its interval; of a single test without one, its systematic part.
int mean_decimals(const GroupQuantity& group, const Quantity& quantity) {
  std::optional<double> uncertainty = group.systematic_uncertainty;
  if (group.replicates && group.replicates->mean_interval) {
    const double half = half_of(*group.replicates->mean_interval);
    if (half > 0.0) uncertainty = half;
  }
  return io::decimals_for(uncertainty, quantity.decimals);
}

/// "0.3812 ± 0.0012"; without the second part where the scatter is not known.
std::string mean_text(const GroupQuantity& group, const Quantity& quantity) {
  if (!group.replicates) return std::string{io::kAbsent};
  const Replicates& own = *group.replicates;
  const int decimals = mean_decimals(group, quantity);
  if (!own.mean_interval) return number(own.mean, decimals);
  return fmt::format("{:.{}f} ± {:.{}f}", own.mean, decimals, half_of(*own.mean_interval), decimals);
}

/// A scatter, of which two digits mean something.
std::string scatter_text(const std::optional<double>& scatter, int plain) {
  return number(scatter, io::decimals_for(scatter, plain));
}

std::string count_of_tests(std::size_t count) {
  return fmt::format("{} test{}", count, count == 1 ? "" : "s");
}

/// Fig. 1 has the first two; S and K stand below them: four would not fit a terminal of 80 columns.
constexpr std::size_t kFigureQuantities = 4;
constexpr std::size_t kBesideEachOther = 2;

io::Table figure_table(bool two, std::size_t first) {
  using enum io::Table::Align;
  std::vector<io::Table::Column> columns{{.heading = two ? "speed" : "group", .align = two ? kLeft : kRight},
                                         {.heading = two ? "" : "n", .align = two ? kLeft : kRight}};
  for (std::size_t q = first; q < first + kBesideEachOther; ++q)
    columns.push_back({.heading = std::string{analysis::quantities()[q].label}, .width = 17});
  return io::Table{std::move(columns)};
}

struct FigureRow {
  io::Table::Cell first;
  io::Table::Cell second;
  const SpeedGroup* group;
};

std::string figure_text(bool two, const std::vector<FigureRow>& rows) {
  std::string text;
  for (std::size_t first = 0; first < kFigureQuantities; first += kBesideEachOther) {
    io::Table table = figure_table(two, first);
    for (const FigureRow& row : rows) {
      std::vector<io::Table::Cell> cells{row.first, row.second};
      for (std::size_t q = first; q < first + kBesideEachOther; ++q)
        cells.emplace_back(mean_text(row.group->quantities[q], analysis::quantities()[q]));
      table.add(std::move(cells));
    }
    text += table.text();
  }
  return text;
}

constexpr std::string_view kMeansHeading = "Means, ± half of the 95 % interval";

/// "k = 4.30 for n = 3, 2.78 for n = 5": of all intervals that are shown.
std::string coverage_legend(std::initializer_list<const Material*> materials) {
  std::map<std::size_t, double> factors;
  for (const Material* const material : materials) {
    for (const SpeedGroup& group : material->groups) {
      for (const GroupQuantity& own : group.quantities) {
        if (own.replicates && own.replicates->coverage_factor)
          factors[own.replicates->count] = *own.replicates->coverage_factor;
      }
    }
  }
  std::string text;
  for (const auto& [count, factor] : factors)
    text += fmt::format("{}{:.2f} for n = {}", text.empty() ? "" : ", ", factor, count);
  if (text.empty()) return text;
  return wrapped("95 % intervals: mean ± k s_r/√n, Student's t, k = " + text, 3) + "\n";
}

constexpr std::string_view kModelLegend =
    "static µs: ISO 8295 µS; kinetic (dynamic) µk\n"
    "model quantities: S, K, S−K, frequency ω/2π, γ/2ω (Penner 1995)\n";

constexpr int kDeltaMuDecimals = 4;

/// Of all slips of the tests of a group, before the means of the tests; with its errors.
/// \param side  "A: " or "B: " of a comparison.
std::string by_cycle_line(const analysis::PooledDeltaMu& pooled, std::string_view side = {}) {
  constexpr std::size_t kIndent = 15;
  std::string text = fmt::format("{}S−K by cycle   ", side);
  if (!pooled.mean.value)
    return wrapped(fmt::format("{}{}  {}", text, io::kAbsent, base::printable(pooled.mean.reason)), kIndent) +
           "\n";
  text += io::uncertain(pooled.mean, kDeltaMuDecimals).text();
  if (const auto of_mean = analysis::mean_interval(pooled))
    text +=
        fmt::format(", 95 % {}", interval(of_mean, io::decimals_for(half_of(*of_mean), kDeltaMuDecimals)));
  text += fmt::format(": {} slip{} of {}, {} escaped", pooled.slip_count, pooled.slip_count == 1 ? "" : "s",
                      count_of_tests(pooled.test_count), pooled.escaped_count);
  if (pooled.scatter.value) text += ", scatter " + scatter_text(pooled.scatter.value, kDeltaMuDecimals);
  return wrapped(text, kIndent) + "\n";
}

/// What the errors of those lines mean; empty if no line has errors.
std::string by_cycle_legend(std::initializer_list<const Material*> materials) {
  bool has_error = false;
  bool has_systematic = false;
  bool all_significant = true;
  for (const Material* const material : materials) {
    for (const SpeedGroup& group : material->groups) {
      const analysis::Estimate& mean = group.by_cycle.mean;
      has_error |= mean.standard_error.has_value();
      has_systematic |= mean.systematic_uncertainty.has_value();
      all_significant &= io::uncertain(mean, kDeltaMuDecimals).significant;
    }
  }
  std::string text;
  if (has_error || has_systematic) {
    text = fmt::format("\nS−K by cycle: {}\n", has_systematic ? io::kErrorsLegend : io::kStandardErrorLegend);
  }
  if (!all_significant) text += fmt::format("{}\n", io::kNotSignificantLegend);
  return text;
}

std::string title_of(const Quantity& quantity) {
  return quantity.unit == "1" ? std::string{quantity.label}
                              : fmt::format("{} ({})", quantity.label, quantity.unit);
}

std::string replicates_table(const Material& material, const SpeedGroup& group) {
  std::vector<io::Table::Column> columns{{.heading = "", .align = io::Table::Align::kLeft, .width = 10},
                                         {.heading = "n", .width = 3},
                                         {.heading = "mean", .width = 8}};
  const bool has_systematic =
      std::any_of(group.quantities.begin(), group.quantities.end(),
                  [](const GroupQuantity& own) { return own.systematic_uncertainty.has_value(); });
  if (has_systematic) columns.push_back({.heading = "± syst.", .width = 8});
  columns.insert(columns.end(), {{.heading = "s_r", .width = 8},
                                 {.heading = "r = 2.8 s_r"},
                                 {.heading = "95 % of the mean", .width = 19}});
  io::Table table{std::move(columns)};
  std::string notes;
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    const Quantity& quantity = analysis::quantities()[q];
    const GroupQuantity& own = group.quantities[q];
    const Replicates none;
    const Replicates& values = own.replicates ? *own.replicates : none;
    std::vector<io::Table::Cell> cells{
        title_of(quantity), io::cell(values.count),
        number(own.replicates ? std::optional{values.mean} : std::nullopt, mean_decimals(own, quantity))};
    if (has_systematic) cells.emplace_back(scatter_text(own.systematic_uncertainty, quantity.decimals));
    cells.insert(cells.end(), {scatter_text(values.standard_deviation, quantity.decimals),
                               scatter_text(values.repeatability, quantity.decimals),
                               interval(values.mean_interval, mean_decimals(own, quantity))});
    table.add(std::move(cells));
    if (values.outlier) {
      const std::size_t test = own.tests[values.outlier->index];
      notes +=
          wrapped(fmt::format("!  {} of {} stands out (Grubbs {:.2f} above {:.2f}, 5 %); it is not left out",
                              quantity.title, base::printable(material.tests[test].file),
                              values.outlier->statistic, values.outlier->critical),
                  3) +
          "\n";
    }
  }
  return table.text() + notes;
}

std::string limits_lines(const Material& material) {
  std::string text;
  for (const daemon::LimitVerdict& own : material.limits) {
    const auto side = [](const std::optional<double>& limit) {
      return limit ? fmt::format("{}", *limit) : std::string{io::kAbsent};
    };
    text +=
        fmt::format("{}  {} {} … {}: {} of {} inside", own.passes() ? "pass" : "FAIL", own.quantity,
                    side(own.limits.lowest), side(own.limits.highest),
                    material.tests.size() - own.outside.size() - own.absent.size(), material.tests.size());
    for (const auto& [what, tests] : {std::pair{"outside", &own.outside}, {"no value", &own.absent}}) {
      if (tests->empty()) continue;
      text += fmt::format("; {}: test", what);
      for (const std::size_t test : *tests) text += fmt::format(" {}", test + 1);
    }
    text += "\n";
  }
  return text;
}

std::string voided_lines(const Material& material) {
  std::string text;
  for (const VoidedTest& test : material.voided) {
    text += fmt::format("x  {}: void, left out: {} ({}, {})\n", base::printable(test.file),
                        base::printable(test.voiding.reason), base::printable(test.voiding.who),
                        base::printable(test.voiding.at));
  }
  return text;
}

std::string tests_table(const Material& material) {
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    rows.push_back({static_cast<std::int64_t>(i) + 1, material.measured[i].results, material.tests[i].truth,
                    material.tests[i].file});
  }
  std::string text = format_table(rows);
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    for (const std::string& line : material.tests[i].departures)
      text += fmt::format("!  test {}: {}\n", i + 1, base::printable(line));
  }
  for (std::size_t i = 0; i < material.tests.size(); ++i) {
    for (const auto& [key, value] : material.tests[i].sample.metadata)
      text += fmt::format("   test {}: {}: {}\n", i + 1, base::printable(key), base::printable(value));
  }
  return text + voided_lines(material);
}

std::string methods_line(const Material& material) {
  std::map<std::string, std::size_t> counts;
  for (const ReportedTest& test : material.tests) {
    const std::string method = test.method.empty() ? "method not known" : test.method;
    ++counts[test.estimator == "fit" ? method : fmt::format("{}, estimator {}", method, test.estimator)];
  }
  std::string text;
  for (const auto& [method, count] : counts) {
    text += fmt::format("{}{}{}", text.empty() ? "" : "; ", base::printable(method),
                        counts.size() > 1 ? fmt::format(" ({})", count_of_tests(count)) : "");
  }
  return text;
}

std::string p_text(double p) { return p < 0.0001 ? "< 0.0001" : fmt::format("{:.4f}", p); }

std::string needed_text(const std::optional<int>& count) {
  return count ? fmt::format("{}", *count) : fmt::format("> {}", analysis::kMostTestsNeeded);
}

std::string regime_line(const RegimeComparison& regime) {
  if (!regime.p) return {};
  const auto counts = [](const RegimeCounts& own) {
    return fmt::format("{} of {}", own.sticking, own.sticking + own.sliding);
  };
  return fmt::format("sticking       A {}, B {}, p {} (Fisher's exact test){}\n", counts(regime.a),
                     counts(regime.b), p_text(*regime.p), *regime.p < analysis::kSignificance ? "  *" : "");
}

std::string speed_of(const Material& a, const Material& b, const analysis::SpeedPair& pair) {
  return pair.a ? report::speed_of(a, a.groups[*pair.a]) : report::speed_of(b, b.groups[*pair.b]);
}

std::string comparison_table(const analysis::PooledComparison& by_cycle,
                             const std::array<analysis::Comparison, analysis::kQuantityCount>& comparisons) {
  const std::string& first = comparisons.front().reason;
  const auto same = [&first](const analysis::Comparison& own) { return own.reason == first; };
  if (!first.empty() && std::all_of(comparisons.begin(), comparisons.end(), same)) {
    return fmt::format("{}  {}\n", io::kAbsent, base::printable(first));
  }
  using enum io::Table::Align;
  io::Table table{{{.heading = "", .align = kLeft, .width = 13},
                   {.heading = "A − B", .width = 10},
                   {.heading = "95 %", .width = 22},
                   {.heading = "p (Welch)"},
                   {.heading = "g", .format = ".2f", .width = 8},
                   {.heading = "95 % of g", .width = 18},
                   {.heading = "tests 80/90 %", .width = 14},
                   {.heading = "", .align = kLeft}}};
  const auto star = [](double p) { return p < analysis::kSignificance ? "*" : ""; };
  std::map<std::string, std::string> reasons;
  if (by_cycle.welch) {
    const int decimals = io::decimals_for(half_of(by_cycle.welch->interval), kDeltaMuDecimals);
    table.add({"S−K by cycle", number(by_cycle.welch->difference, decimals),
               interval(by_cycle.welch->interval, decimals), p_text(by_cycle.welch->p), "", "", "",
               star(by_cycle.welch->p)});
  } else {
    table.add({"S−K by cycle", {}});
    reasons[by_cycle.reason] = "S−K by cycle";
  }
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    const Quantity& quantity = analysis::quantities()[q];
    const analysis::Comparison& own = comparisons[q];
    if (!own.welch) {
      table.add({title_of(quantity), {}});
      std::string& titles = reasons[own.reason];
      titles += fmt::format("{}{}", titles.empty() ? "" : ", ", quantity.title);
      continue;
    }
    const int decimals = io::decimals_for(half_of(own.welch->interval), quantity.decimals);
    table.add({title_of(quantity), number(own.welch->difference, decimals),
               interval(own.welch->interval, decimals), p_text(own.welch->p), own.effect->g,
               interval(own.effect->interval, 1),
               fmt::format("{} / {}", needed_text(own.needed->for_80_percent),
                           needed_text(own.needed->for_90_percent)),
               star(own.welch->p)});
  }
  std::string text = table.text();
  for (const auto& [reason, titles] : reasons)
    text += fmt::format("{}  no {}: {}\n", io::kAbsent, titles, base::printable(reason));
  return text;
}

/// The form block: what was tested, how, by whom and with what.
std::string form_text(const Material& material) {
  constexpr std::size_t kLabelWidth = 17;
  std::string text;
  for (const FormLine& line : form_of(material)) {
    text += wrapped(io::padded(line.label, kLabelWidth) + base::printable(line.text), kLabelWidth) + "\n";
  }
  return text + wrapped(io::padded("verdict", kLabelWidth) + verdict_of(material), kLabelWidth) + "\n" +
         limits_lines(material);
}

}  // namespace

std::string report_text(const Material& material) {
  std::string text =
      form_text(material) + "\n" + tests_table(material) + "method: " + methods_line(material) + "\n";
  text += fmt::format("\n{}{}\n", has_speeds(material) ? "Coefficient against speed (Fig. 1). " : "",
                      kMeansHeading);
  std::vector<FigureRow> rows;
  for (std::size_t g = 0; g < material.groups.size(); ++g) {
    const SpeedGroup& group = material.groups[g];
    rows.push_back({io::cell(g + 1), io::cell(group.tests.size()), &group});
  }
  text += figure_text(false, rows);
  for (std::size_t g = 0; g < material.groups.size(); ++g) {
    const SpeedGroup& group = material.groups[g];
    text += fmt::format("\ngroup {}: {}, {}\n", g + 1, base::printable(group_text(material, group)),
                        count_of_tests(group.tests.size()));
    text += by_cycle_line(group.by_cycle) + replicates_table(material, group);
    if (const std::string budget = budget_text(budgets_of(material.measured, group)); !budget.empty())
      text += fmt::format("\nuncertainty budget of {}\n{}",
                          group.tests.size() == 1 ? "this test" : "these means", budget);
  }
  text += by_cycle_legend({&material}) + coverage_legend({&material}) + std::string{kModelLegend};
  if (const std::string split = not_pooled_text(material); !split.empty()) text += split + "\n";
  return text;
}

std::string comparison_text(const Material& a, const Material& b, const MaterialComparison& comparison) {
  std::string text = fmt::format("A: {}\n{}\n{}method: {}\n\nB: {}\n{}\n{}method: {}\n",
                                 base::printable(a.label), form_text(a), tests_table(a), methods_line(a),
                                 base::printable(b.label), form_text(b), tests_table(b), methods_line(b));
  text += fmt::format("\n{}{}\n", comparison.pairs.size() > 1 ? "Coefficient against speed (Fig. 1). " : "",
                      kMeansHeading);
  std::vector<FigureRow> rows;
  for (const analysis::SpeedPair& pair : comparison.pairs) {
    std::string speed = speed_of(a, b, pair);
    if (pair.a) rows.push_back({std::exchange(speed, ""), "A", &a.groups[*pair.a]});
    if (pair.b) rows.push_back({speed, "B", &b.groups[*pair.b]});
  }
  text += figure_text(true, rows);
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const analysis::SpeedPair& pair = comparison.pairs[i];
    text += fmt::format("\n{}: A − B (* differs at 5 %)\n", speed_of(a, b, pair));
    if (pair.a) text += by_cycle_line(a.groups[*pair.a].by_cycle, "A: ");
    if (pair.b) text += by_cycle_line(b.groups[*pair.b].by_cycle, "B: ");
    text += comparison_table(comparison.by_cycle[i], comparison.comparisons[i]) +
            regime_line(comparison.regimes[i]);
  }
  std::string combined;
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    if (!comparison.combined[q]) continue;
    combined += fmt::format("{}{} {}", combined.empty() ? "" : ", ", analysis::quantities()[q].title,
                            p_text(comparison.combined[q]->p));
  }
  if (!combined.empty()) text += "\nall speeds together, p (Fisher): " + combined + "\n";
  return text + by_cycle_legend({&a, &b}) + coverage_legend({&a, &b}) + std::string{kModelLegend};
}

}  // namespace stickslip::report
