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
#include "report/millimetres.hpp"
#include "report/truth_table.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

using analysis::GroupQuantity;
using analysis::Interval;
using analysis::Quantity;
using analysis::Replicates;
using analysis::SpeedGroup;

std::string speed_text(const std::optional<double>& speed_m_per_s) {
  if (!speed_m_per_s) return "speed not known";
  return fmt::format("{:.4g} mm/s", *speed_m_per_s * kMillimetresPerMetre);
}

std::string number(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string{io::kAbsent};
}

std::string interval(const std::optional<Interval>& value, int decimals) {
  return value ? fmt::format("{:.{}f} … {:.{}f}", value->low, decimals, value->high, decimals)
               : std::string{io::kAbsent};
}

/// "0.3812 ± 0.0012"; without the second part where the scatter is not known.
std::string mean_text(const GroupQuantity& group, const Quantity& quantity) {
  if (!group.replicates) return std::string{io::kAbsent};
  const Replicates& own = *group.replicates;
  if (!own.mean_interval) return number(own.mean, quantity.decimals);
  return fmt::format("{:.{}f} ± {:.{}f}", own.mean, quantity.decimals, own.mean_interval->high - own.mean,
                     quantity.decimals);
}

std::string count_of_tests(std::size_t count) {
  return fmt::format("{} test{}", count, count == 1 ? "" : "s");
}

/// Fig. 1 has the first two; S and K stand beside them.
constexpr std::size_t kFigureQuantities = 4;

io::Table figure_table(bool two) {
  using enum io::Table::Align;
  std::vector<io::Table::Column> columns{{.heading = "speed", .align = kLeft, .width = 14},
                                         {.heading = two ? "material" : "", .align = kLeft, .width = 12},
                                         {.heading = "tests"}};
  for (std::size_t q = 0; q < kFigureQuantities; ++q)
    columns.push_back({.heading = std::string{analysis::quantities()[q].title}, .width = 17});
  return io::Table{std::move(columns)};
}

void add_to_figure(io::Table& table, const std::string& speed, const std::string& label,
                   const SpeedGroup& group) {
  std::vector<io::Table::Cell> cells{speed, label, io::cell(group.tests.size())};
  for (std::size_t q = 0; q < kFigureQuantities; ++q)
    cells.emplace_back(mean_text(group.quantities[q], analysis::quantities()[q]));
  table.add(std::move(cells));
}

constexpr int kDeltaMuDecimals = 4;

/// Of all slips of the tests of a group, before the means of the tests; with its errors.
std::string by_cycle_line(const analysis::PooledDeltaMu& pooled) {
  if (!pooled.mean.value)
    return fmt::format("S−K by cycle   {}  {}\n", io::kAbsent, base::printable(pooled.mean.reason));
  std::string text = "S−K by cycle   " + io::uncertain(pooled.mean, kDeltaMuDecimals).text();
  if (const auto of_mean = analysis::mean_interval(pooled))
    text += fmt::format(", 95 % {}", interval(of_mean, kDeltaMuDecimals));
  text += fmt::format(": {} slip{} of {}, {} escaped", pooled.slip_count, pooled.slip_count == 1 ? "" : "s",
                      count_of_tests(pooled.test_count), pooled.escaped_count);
  if (pooled.scatter.value)
    text += fmt::format(", scatter {:.{}f}", *pooled.scatter.value, kDeltaMuDecimals + 1);
  return text + "\n";
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
  return quantity.unit == "1" ? std::string{quantity.title}
                              : fmt::format("{} ({})", quantity.title, quantity.unit);
}

std::string replicates_table(const Material& material, const SpeedGroup& group) {
  std::vector<io::Table::Column> columns{{.heading = "", .align = io::Table::Align::kLeft, .width = 13},
                                         {.heading = "n", .width = 4},
                                         {.heading = "mean", .width = 9}};
  const bool has_systematic =
      std::any_of(group.quantities.begin(), group.quantities.end(),
                  [](const GroupQuantity& own) { return own.systematic_uncertainty.has_value(); });
  if (has_systematic) columns.push_back({.heading = "± syst."});
  columns.insert(columns.end(), {{.heading = "s_r", .width = 9},
                                 {.heading = "r = 2.8 s_r"},
                                 {.heading = "95 % of the mean", .width = 20}});
  io::Table table{std::move(columns)};
  std::string notes;
  for (std::size_t q = 0; q < analysis::kQuantityCount; ++q) {
    const Quantity& quantity = analysis::quantities()[q];
    const GroupQuantity& own = group.quantities[q];
    const Replicates none;
    const Replicates& values = own.replicates ? *own.replicates : none;
    std::vector<io::Table::Cell> cells{
        title_of(quantity), io::cell(values.count),
        number(own.replicates ? std::optional{values.mean} : std::nullopt, quantity.decimals)};
    if (has_systematic) cells.emplace_back(number(own.systematic_uncertainty, quantity.decimals));
    cells.insert(cells.end(), {number(values.standard_deviation, quantity.decimals + 1),
                               number(values.repeatability, quantity.decimals + 1),
                               interval(values.mean_interval, quantity.decimals)});
    table.add(std::move(cells));
    if (values.outlier) {
      const std::size_t test = own.tests[values.outlier->index];
      notes += fmt::format("!  {} of {} stands out (Grubbs {:.2f} above {:.2f}, 5 %); it is not left out\n",
                           quantity.title, base::printable(material.tests[test].file),
                           values.outlier->statistic, values.outlier->critical);
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
  return text.empty() ? text : "\nLimits of the batch\n" + text;
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
    for (const auto& [key, value] : material.tests[i].metadata)
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
    table.add({"S−K by cycle", number(by_cycle.welch->difference, kDeltaMuDecimals),
               interval(by_cycle.welch->interval, kDeltaMuDecimals), p_text(by_cycle.welch->p), "", "", "",
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
    table.add({title_of(quantity), number(own.welch->difference, quantity.decimals),
               interval(own.welch->interval, quantity.decimals), p_text(own.welch->p), own.effect->g,
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

}  // namespace

std::string report_text(const Material& material) {
  std::string text = tests_table(material) + "method: " + methods_line(material) + "\n";
  text += "\nCoefficient against speed (Fig. 1): mean ± half of its 95 % interval\n";
  io::Table figure = figure_table(false);
  for (const SpeedGroup& group : material.groups)
    add_to_figure(figure, speed_text(group.pull_speed_m_per_s), "", group);
  text += figure.text();
  for (const SpeedGroup& group : material.groups) {
    text +=
        fmt::format("\n{}, {}\n", speed_text(group.pull_speed_m_per_s), count_of_tests(group.tests.size()));
    text += by_cycle_line(group.by_cycle) + replicates_table(material, group);
  }
  return text + by_cycle_legend({&material}) + limits_lines(material);
}

std::string comparison_text(const Material& a, const Material& b, const MaterialComparison& comparison) {
  std::string text =
      fmt::format("A: {}\n{}method: {}\n\nB: {}\n{}method: {}\n", base::printable(a.label), tests_table(a),
                  methods_line(a), base::printable(b.label), tests_table(b), methods_line(b));
  text += "\nCoefficient against speed (Fig. 1): mean ± half of its 95 % interval\n";
  io::Table figure = figure_table(true);
  for (const analysis::SpeedPair& pair : comparison.pairs) {
    std::string speed = speed_text(pair.pull_speed_m_per_s);
    if (pair.a) add_to_figure(figure, std::exchange(speed, ""), "A", a.groups[*pair.a]);
    if (pair.b) add_to_figure(figure, speed, "B", b.groups[*pair.b]);
  }
  text += figure.text();
  for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
    const analysis::SpeedPair& pair = comparison.pairs[i];
    text +=
        fmt::format("\n{}: A − B (* differs at 5 %)\n", speed_text(comparison.pairs[i].pull_speed_m_per_s));
    if (pair.a) text += "A: " + by_cycle_line(a.groups[*pair.a].by_cycle);
    if (pair.b) text += "B: " + by_cycle_line(b.groups[*pair.b].by_cycle);
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
  return text + by_cycle_legend({&a, &b});
}

}  // namespace stickslip::report
