#include "core/analysis/group_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <boost/math/distributions/students_t.hpp>

namespace stickslip::analysis {
namespace {

using enum BudgetState;

/// Less coverage than that of the normal distribution for k = 2, 95.4 %, by this much is said.
constexpr double kSaidCoverage = 0.9445;

struct OwnBudget {
  UncertaintyBudget budget;
  double systematic = 0.0;  ///< 0: unknown.
};

/// The same source over the tests.
struct MeanLine {
  BudgetLine line;
  double size_sum = 0.0;
  double sized = 0.0;
  double contribution_sum = 0.0;
  std::size_t unknown = 0;
  std::string why_unknown;
};

/// Whether its variance is a part of the systematic uncertainty's.
bool is_recorded(const BudgetLine& line) { return line.type == 'B' && line.source != "speed"; }

std::vector<MeanLine> mean_lines(const std::vector<OwnBudget>& tests) {
  std::vector<MeanLine> lines;
  for (const OwnBudget& test : tests) {
    for (const BudgetLine& line : test.budget.lines) {
      auto found = std::ranges::find_if(
          lines, [&](const MeanLine& other) { return other.line.source == line.source; });
      if (found == lines.end()) {
        lines.push_back({line, 0.0, 0.0, 0.0, 0, {}});
        found = std::prev(lines.end());
      }
      if (line.state == kUnknown) {
        ++found->unknown;
        found->why_unknown = line.note;
        continue;
      }
      // A source that counts in one test counts in the mean.
      if (found->line.state != kCounted) found->line = line;
      found->size_sum += line.size.value_or(0.0);
      found->sized += line.size ? 1.0 : 0.0;
      if (line.state == kCounted && is_recorded(line) && test.systematic > 0.0)
        found->contribution_sum += line.variance / test.systematic;
    }
  }
  return lines;
}

/// Probability of ±k by Student's t with the effective degrees of freedom of Welch and Satterthwaite; only
/// the replicates have few [JCGM 100:2008, G.4.1].
std::optional<double> coverage_of(double combined, double of_replicates, std::size_t count) {
  if (count < 2 || !(of_replicates > 0.0) || !std::isfinite(combined)) return std::nullopt;
  const double freedom = static_cast<double>(count - 1) * std::pow(combined / of_replicates, 4);
  if (!std::isfinite(freedom)) return std::nullopt;
  const double coverage = 1.0 - 2.0 * boost::math::cdf(boost::math::complement(
                                          boost::math::students_t{freedom}, kCoverageFactor));
  return coverage < kSaidCoverage ? std::optional{coverage} : std::nullopt;
}

/// A number of a group with what its errors are of.
struct GroupNumber {
  double value = 0.0;
  double standard_error = 0.0;
  double systematic = 0.0;
  std::vector<std::size_t> tests;
};

GroupNumber number_of(std::span<const MeasuredTest> tests, const SpeedGroup& group, std::size_t q) {
  const GroupQuantity& own = group.quantities[q];
  const Estimate& pooled = group.by_cycle.mean;
  if (quantities()[q].estimate == &TestResults::delta_mu && pooled.value && pooled.standard_error) {
    std::vector<std::size_t> with_slips;
    for (const std::size_t test : group.tests) {
      if (tests[test].slips.count > 0.0) with_slips.push_back(test);
    }
    return {*pooled.value, *pooled.standard_error, pooled.systematic_uncertainty.value_or(0.0), with_slips};
  }
  return {own.replicates->mean,
          own.replicates->standard_deviation.value_or(0.0) /
              std::sqrt(static_cast<double>(own.replicates->count)),
          own.systematic_uncertainty.value_or(0.0), own.tests};
}

}  // namespace

std::optional<UncertaintyBudget> group_budget(std::span<const MeasuredTest> tests, const SpeedGroup& group,
                                              std::size_t quantity) {
  const Quantity& which = quantities()[quantity];
  const GroupQuantity& own = group.quantities[quantity];
  if (!own.replicates) return std::nullopt;
  if (own.tests.size() == 1) {
    const MeasuredTest& test = tests[own.tests.front()];
    return test_budget(test.results, which, test.budget_facts);
  }
  const GroupNumber number = number_of(tests, group, quantity);
  std::vector<OwnBudget> of_tests;
  double with_systematic = 0.0;
  for (const std::size_t test : number.tests) {
    if (auto budget = test_budget(tests[test].results, which, tests[test].budget_facts)) {
      const double systematic = (tests[test].results.*which.estimate).systematic_uncertainty.value_or(0.0);
      with_systematic += (tests[test].results.*which.estimate).systematic_uncertainty ? 1.0 : 0.0;
      of_tests.push_back({*std::move(budget), systematic});
    }
  }
  UncertaintyBudget budget;
  budget.value = number.value;
  for (MeanLine& mean : mean_lines(of_tests)) {
    BudgetLine line = std::move(mean.line);
    if (line.source == "replicates") {
      line = {line.source,
              line.title,
              'A',
              kCounted,
              number.standard_error,
              number.standard_error * number.standard_error,
              {}};
    } else if (line.source == "noise") {
      line.state = kIncluded;
      line.note = "in the replicates";
      line.variance = 0.0;
      line.size = mean.sized > 0.0 ? std::optional{mean.size_sum / mean.sized} : std::nullopt;
    } else if (line.state != kUnknown) {
      // Absent in a test that has other parts, a part is zero there.
      const double count = is_recorded(line) && line.state == kCounted ? with_systematic : mean.sized;
      line.size =
          mean.sized > 0.0 ? std::optional{mean.size_sum / std::max(count, mean.sized)} : std::nullopt;
      if (line.state == kCounted) {
        line.variance = is_recorded(line)
                            ? number.systematic * mean.contribution_sum / std::max(with_systematic, 1.0)
                            : *line.size * *line.size;
      }
      if (line.source == "resolution") line.note = "in the replicates";
      if (mean.unknown > 0)
        line.note =
            fmt::format("not known in {} of {} tests: {}", mean.unknown, of_tests.size(), mean.why_unknown);
    }
    budget.lines.push_back(std::move(line));
  }
  combine(budget);
  if (budget.combined)
    budget.coverage = coverage_of(*budget.combined, number.standard_error, number.tests.size());
  return budget;
}

}  // namespace stickslip::analysis
