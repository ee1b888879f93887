#include "core/analysis/grouping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stickslip::analysis {
namespace {

bool same_speed(const std::optional<double>& one, const std::optional<double>& other) {
  if (!one || !other) return one.has_value() == other.has_value();
  return std::abs(*one - *other) <= kSameSpeed * std::max(std::abs(*one), std::abs(*other));
}

bool slower(const std::optional<double>& one, const std::optional<double>& other) {
  if (!one || !other) return one.has_value() && !other.has_value();
  return *one < *other;
}

GroupQuantity summary(std::span<const MeasuredTest> tests, const SpeedGroup& group,
                      const Quantity& quantity) {
  GroupQuantity result;
  std::vector<double> values;
  std::vector<const Estimate*> estimates;
  for (const std::size_t test : group.tests) {
    const Estimate& estimate = tests[test].results.*quantity.estimate;
    if (estimate.value) {
      values.push_back(*estimate.value);
      estimates.push_back(&estimate);
      result.tests.push_back(test);
    } else {
      result.absences.push_back({test, estimate.reason});
    }
  }
  if (!values.empty()) result.replicates = describe_replicates(values);
  result.systematic_uncertainty = mean_systematic(estimates);
  return result;
}

}  // namespace

std::optional<double> mean_systematic(std::span<const Estimate* const> estimates) {
  double sum = 0.0;
  double count = 0.0;
  for (const Estimate* const estimate : estimates) {
    if (!estimate->systematic_uncertainty) continue;
    sum += *estimate->systematic_uncertainty;
    count += 1.0;
  }
  return count > 0.0 ? std::optional{sum / count} : std::nullopt;
}

PooledDeltaMu pool_tests(std::span<const MeasuredTest* const> tests) {
  std::vector<SlipSums> slips;
  std::vector<const Estimate*> estimates;
  for (const MeasuredTest* const test : tests) {
    slips.push_back(test->slips);
    if (test->slips.count > 0.0) estimates.push_back(&test->results.delta_mu);
  }
  PooledDeltaMu pooled = pool_slips(slips);
  pooled.mean.systematic_uncertainty = mean_systematic(estimates);
  return pooled;
}

model::Regime grouping_regime(model::Regime regime) noexcept {
  return regime == model::Regime::kMixed ? model::Regime::kStickSlip : regime;
}

std::vector<SpeedGroup> group_by_speed(std::span<const MeasuredTest> tests, Pooling pooling) {
  std::vector<SpeedGroup> groups;
  const auto belongs = [&tests, pooling](const SpeedGroup& group, const MeasuredTest& test) {
    const MeasuredTest& first = tests[group.tests.front()];
    return same_speed(group.pull_speed_m_per_s, test.pull_speed_m_per_s) &&
           (pooling.grades || first.grade == test.grade) &&
           (pooling.regimes || grouping_regime(first.results.regime) == grouping_regime(test.results.regime));
  };
  const auto note = [](auto& seen, const auto& value) {
    if (std::find(seen.begin(), seen.end(), value) == seen.end()) seen.push_back(value);
  };
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const MeasuredTest& test = tests[i];
    auto found = std::find_if(groups.begin(), groups.end(),
                              [&](const SpeedGroup& group) { return belongs(group, test); });
    if (found == groups.end()) {
      SpeedGroup made{};
      made.pull_speed_m_per_s = test.pull_speed_m_per_s;
      found = groups.insert(groups.end(), std::move(made));
    }
    found->tests.push_back(i);
    note(found->grades, test.grade);
    note(found->regimes, test.results.regime);
  }
  std::stable_sort(groups.begin(), groups.end(), [](const SpeedGroup& one, const SpeedGroup& other) {
    return slower(one.pull_speed_m_per_s, other.pull_speed_m_per_s);
  });
  for (SpeedGroup& group : groups) {
    std::vector<const MeasuredTest*> own;
    for (const std::size_t test : group.tests) own.push_back(&tests[test]);
    group.by_cycle = pool_tests(own);
    for (std::size_t q = 0; q < kQuantityCount; ++q)
      group.quantities[q] = summary(tests, group, quantities()[q]);
  }
  return groups;
}

std::optional<double> pooled_over_groups(std::span<const SpeedGroup> groups, std::size_t quantity) {
  std::vector<Replicates> replicates;
  for (const SpeedGroup& group : groups) {
    if (const auto& own = group.quantities[quantity].replicates) replicates.push_back(*own);
  }
  return pooled_standard_deviation(replicates);
}

std::vector<SpeedPair> pair_speeds(std::span<const SpeedGroup> a, std::span<const SpeedGroup> b) {
  std::vector<SpeedPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) pairs.push_back({a[i].pull_speed_m_per_s, i, std::nullopt});
  for (std::size_t i = 0; i < b.size(); ++i) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const SpeedPair& pair) {
      return !pair.b && same_speed(pair.pull_speed_m_per_s, b[i].pull_speed_m_per_s);
    });
    if (found == pairs.end()) {
      pairs.push_back({b[i].pull_speed_m_per_s, std::nullopt, i});
    } else {
      found->b = i;
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const SpeedPair& one, const SpeedPair& other) {
    return slower(one.pull_speed_m_per_s, other.pull_speed_m_per_s);
  });
  return pairs;
}

namespace {

/// Why nothing can be compared; empty if both have tests at this speed.
std::string missing_side(const SpeedPair& pair) {
  if (!pair.a) return "no test of A at this speed";
  return pair.b ? "" : "no test of B at this speed";
}

}  // namespace

PooledComparison compare_pair_by_cycle(std::span<const SpeedGroup> a, std::span<const SpeedGroup> b,
                                       const SpeedPair& pair) {
  if (std::string reason = missing_side(pair); !reason.empty()) return {{}, std::move(reason)};
  return compare_pooled(a[*pair.a].by_cycle, b[*pair.b].by_cycle);
}

Comparison compare_pair(std::span<const SpeedGroup> a, std::span<const SpeedGroup> b, const SpeedPair& pair,
                        std::size_t quantity) {
  Comparison none;
  none.reason = missing_side(pair);
  if (!none.reason.empty()) return none;
  const GroupQuantity& of_a = a[*pair.a].quantities[quantity];
  const GroupQuantity& of_b = b[*pair.b].quantities[quantity];
  for (const auto& [side, group] : {std::pair{"A", &of_a}, std::pair{"B", &of_b}}) {
    if (group->replicates) continue;
    none.reason = std::string{"no test of "} + side + " has a value: " + group->absences.front().reason;
    return none;
  }
  return compare(*of_a.replicates, *of_b.replicates);
}

}  // namespace stickslip::analysis
