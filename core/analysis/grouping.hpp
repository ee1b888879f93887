/// \file
/// Tests by their pull speed, as in Fig. 1 of [Penner 1995], and two materials at equal speeds.
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
#include "core/analysis/results.hpp"

namespace stickslip::analysis {

/// Nominal speeds that differ by less are one: what is typed in in/min and in mm/s differs in its last
/// digits, and no two speeds that a laboratory chooses are as close.
inline constexpr double kSameSpeed = 0.01;

struct MeasuredTest {
  std::optional<double> pull_speed_m_per_s;  ///< Nominal; none if not known.
  TestResults results;
  SlipSums slips{};  ///< Of its table of cycles; empty if there is none.
};

/// Why one test of a group has no number.
struct Absence {
  std::size_t test = 0;  ///< Index among all tests.
  std::string reason;
};

/// One quantity over the tests of a group.
struct GroupQuantity {
  std::optional<Replicates> replicates;  ///< None if no test has a value.
  std::vector<std::size_t> tests;        ///< Those with a value; Outlier::index points into this.
  std::vector<Absence> absences;
};

struct SpeedGroup {
  std::optional<double> pull_speed_m_per_s;  ///< Of the first test.
  std::vector<std::size_t> tests;            ///< Indices among all tests.
  PooledDeltaMu by_cycle;                    ///< S − K of all their slips.
  std::array<GroupQuantity, kQuantityCount> quantities;
};

/// Rising speeds; tests without one come last.
[[nodiscard]] std::vector<SpeedGroup> group_by_speed(std::span<const MeasuredTest> tests);

/// s_r of a quantity over all groups, each about its own mean.
[[nodiscard]] std::optional<double> pooled_over_groups(std::span<const SpeedGroup> groups,
                                                       std::size_t quantity);

/// The same speed in both materials; an index is none where a material has no test at this speed.
struct SpeedPair {
  std::optional<double> pull_speed_m_per_s;
  std::optional<std::size_t> a;
  std::optional<std::size_t> b;
};

[[nodiscard]] std::vector<SpeedPair> pair_speeds(std::span<const SpeedGroup> a,
                                                 std::span<const SpeedGroup> b);

/// S − K by cycle of both at one speed, or the reason why there is none.
[[nodiscard]] PooledComparison compare_pair_by_cycle(std::span<const SpeedGroup> a,
                                                     std::span<const SpeedGroup> b, const SpeedPair& pair);

/// Comparison of one quantity at one speed, or the reason why there is none.
[[nodiscard]] Comparison compare_pair(std::span<const SpeedGroup> a, std::span<const SpeedGroup> b,
                                      const SpeedPair& pair, std::size_t quantity);

}  // namespace stickslip::analysis
