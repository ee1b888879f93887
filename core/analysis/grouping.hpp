/// \file
/// Tests grouped by pull speed, as in Fig. 1 of [Penner 1995], and two materials compared at equal speeds.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/analysis/comparison.hpp"
#include "core/analysis/pooled.hpp"
#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/quantities.hpp"
#include "core/analysis/replicates.hpp"
#include "core/analysis/rest_groups.hpp"
#include "core/analysis/results.hpp"
#include "core/analysis/uncertainty_budget.hpp"

namespace stickslip::analysis {

/// Relative difference up to which nominal speeds count as equal. The same speed typed in in/min and in mm/s
/// differs in its last digits; speeds that a laboratory distinguishes differ by more.
inline constexpr double kSameSpeed = 0.01;

/// What may be averaged although it differs. By default neither grades nor regimes are: a mean of two papers,
/// or of tests that stuck and tests that rang down, is that of none of them.
struct Pooling {
  bool grades = false;
  bool regimes = false;
};

/// One test with its results: input of group_by_speed(). The daemon, which groups nothing, sets `results` and
/// `slips` alone.
struct MeasuredTest {
  std::optional<double> pull_speed_m_per_s;  ///< Nominal; nullopt if unknown.
  TestResults results;
  /// slip_sums() of its cycles, with the first slips if its analysis kept them; zero without cycles.
  SlipSums slips{};
  std::string grade{};                   ///< Of the paper; empty if not stated.
  std::optional<double> stick_time_s{};  ///< mean_stick_time_s() of the same slips.
  BudgetFacts budget_facts{};
  /// group_by_rest() of its cycles; empty if they have no pull speeds, or if the caller needs none.
  std::vector<RestGroup> rests{};
  /// It has no Q, and its slips are at several pull speeds. False also if the caller does not need it.
  bool speed_changes = false;
};

/// Reason why a test has no value of a quantity.
struct Absence {
  std::size_t test = 0;  ///< Index among all tests.
  std::string reason;
};

/// One quantity over the tests of a group.
struct GroupQuantity {
  std::optional<Replicates> replicates;  ///< Nullopt if no test has a value.
  /// Indices, among all tests, of those with a value. Outlier::index refers to this list.
  std::vector<std::size_t> tests;
  std::vector<Absence> absences;
  std::optional<double> systematic_uncertainty;  ///< Of the mean; nullopt if no test has one.
};

/// Systematic uncertainty of a mean over estimates: the mean of theirs, since replicates do not decrease it.
/// Estimates without one are left out: an unknown uncertainty is not zero. nullopt if none has one.
[[nodiscard]] std::optional<double> mean_systematic(std::span<const Estimate* const> estimates);

/// pool_slips() of MeasuredTest::slips. The systematic uncertainty of the mean is mean_systematic() of
/// delta_mu over the tests whose slips.count is not 0.
[[nodiscard]] PooledDeltaMu pool_tests(std::span<const MeasuredTest* const> tests);

/// Tests at one pull speed, of one grade and one grouping_regime() unless these are pooled.
struct SpeedGroup {
  std::optional<double> pull_speed_m_per_s;              ///< Of the first test.
  std::vector<std::size_t> tests;                        ///< Indices among all tests.
  PooledDeltaMu by_cycle;                                ///< pool_tests() of its tests.
  std::array<GroupQuantity, kQuantityCount> quantities;  ///< In the order of quantities().
  std::vector<std::string> grades;                       ///< Of its tests, each once, in their order.
  std::vector<model::Regime> regimes;                    ///< Of its tests, each once, in their order.
};

/// Regime that decides about a test's group. Mixed counts as stick-slip: the two differ in whether a slip
/// happened to escape, and leaving those tests out would bias S − K (docs/detector-limits.md).
[[nodiscard]] model::Regime grouping_regime(model::Regime regime) noexcept;

/// Groups tests of one pull speed (within kSameSpeed of the group's first test), one grade and one
/// grouping_regime(), unless these are pooled. Unknown speeds count as one speed. The groups are in the order
/// of rising speed, those without a speed last; groups of exactly equal speed in the order of their first
/// tests.
[[nodiscard]] std::vector<SpeedGroup> group_by_speed(std::span<const MeasuredTest> tests,
                                                     Pooling pooling = {});

/// Pooled s_r of a quantity over the groups, each about its own mean; nullopt if no group has two values.
/// \param quantity  index of quantities().
[[nodiscard]] std::optional<double> pooled_over_groups(std::span<const SpeedGroup> groups,
                                                       std::size_t quantity);

/// One speed, that of A where both have it, with the index of a group in each material; nullopt where a
/// material has no further group at this speed.
struct SpeedPair {
  std::optional<double> pull_speed_m_per_s;
  std::optional<std::size_t> a;
  std::optional<std::size_t> b;
};

/// Pairs each group of B with the first group of A at the same speed (kSameSpeed) that has no partner yet,
/// whatever their grades and regimes; groups of unknown speed pair with each other. A group without a partner
/// is a pair of its own. In the order of rising speed, unknown speeds last.
[[nodiscard]] std::vector<SpeedPair> pair_speeds(std::span<const SpeedGroup> a,
                                                 std::span<const SpeedGroup> b);

/// Comparison of S − K pooled by cycle at one speed, or the reason why there is none.
/// \param pair  from pair_speeds() of `a` and `b`.
[[nodiscard]] PooledComparison compare_pair_by_cycle(std::span<const SpeedGroup> a,
                                                     std::span<const SpeedGroup> b, const SpeedPair& pair);

/// Comparison of one quantity at one speed, or the reason why there is none.
/// \param pair  from pair_speeds() of `a` and `b`.
/// \param quantity  index of quantities().
[[nodiscard]] Comparison compare_pair(std::span<const SpeedGroup> a, std::span<const SpeedGroup> b,
                                      const SpeedPair& pair, std::size_t quantity);

}  // namespace stickslip::analysis
