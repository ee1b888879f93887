/// \file
/// Uncertainty budget of a result as in the GUM [JCGM 100:2008]: its sources, their standard uncertainties
/// and shares of the variance, the combined uncertainty u and the expanded one, U = 2 u.
///
///     const auto budget = test_budget(results, quantity, facts);
///     if (budget && budget->combined) print(budget->value, *budget->expanded());   // 0.0463 ± 0.0091
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/analysis/quantities.hpp"
#include "core/analysis/results.hpp"
#include "core/model/method.hpp"

namespace stickslip::analysis {

/// k of the expanded uncertainty: about 95 % of a normal distribution [JCGM 100:2008, 6.3.3].
inline constexpr double kCoverageFactor = 2.0;

/// The quantities that have a budget: S − K, static, kinetic. Indices of quantities().
inline constexpr std::array<std::size_t, 3> kBudgetQuantities{4, 0, 1};

/// What a budget shows beside the results of a test; all may be unknown. Pull speed and method matter to the
/// kinetic coefficient alone.
struct BudgetFacts {
  std::optional<double> step_coefficient{};    ///< One A/D step; nullopt if unknown.
  std::optional<double> pull_speed_m_per_s{};  ///< Planned.
  std::optional<model::Method> method{};       ///< Nullopt if unknown.
};

/// How a source enters a budget.
enum class BudgetState {
  kCounted,   ///< Its variance is a part of u².
  kIncluded,  ///< Is a part of another line; the note says of which.
  kNone,      ///< Does not affect this quantity, or is known to be 0; the note says why.
  kUnknown,   ///< The note says what to do. The combined uncertainty lacks it.
};

[[nodiscard]] std::string_view name(BudgetState state) noexcept;

/// One source of uncertainty in a budget. Numbers are in the unit of the quantity.
struct BudgetLine {
  std::string_view source;  ///< In JSON: "noise", "calibration", …
  std::string_view title;   ///< In tables.
  char type = 'B';          ///< A: by statistics of observations, B: otherwise [JCGM 100:2008, 2.3.2, 2.3.3].
  BudgetState state = BudgetState::kCounted;
  std::optional<double> size{};  ///< Standard uncertainty; counted only if the state says so.
  double variance = 0.0;         ///< Contribution of this source to u².
  std::string note{};            ///< Why the state, or what else to know; may be empty if counted.
};

struct UncertaintyBudget {
  double value = 0.0;
  std::vector<BudgetLine> lines;
  std::optional<double> combined;  ///< u; nullopt: no line is counted.
  /// Probability that ± U covers the quantity, 0 … 1, where few replicates make it less than the normal
  /// distribution's 0.9545 by more than 0.01 [JCGM 100:2008, G.4]; else nullopt.
  std::optional<double> coverage;

  [[nodiscard]] std::optional<double> expanded() const {
    return combined ? std::optional{kCoverageFactor * *combined} : std::nullopt;
  }
  /// Part of u² that is this line's, 0 … 1; 0 if u is 0 or not known.
  [[nodiscard]] double share_of(const BudgetLine& line) const {
    return combined && *combined > 0.0 && std::isfinite(*combined) ? line.variance / (*combined * *combined)
                                                                   : 0.0;
  }
  /// Titles of the sources that are not known: "calibration, zero"; empty if all are.
  [[nodiscard]] std::string unknown() const;
};

/// Budget of one result of a test; nullopt if that has no value. The random part is the standard error, or of
/// the static coefficient, which is one scan, the noise of a scan. The systematic parts are those of the
/// estimate, and the pull speed for a kinetic coefficient over a travel. The line "replicates" is always
/// kUnknown: one test does not tell how sheets scatter.
/// \param quantity  quantities()[i] with i in kBudgetQuantities.
[[nodiscard]] std::optional<UncertaintyBudget> test_budget(const TestResults& results,
                                                           const Quantity& quantity,
                                                           const BudgetFacts& facts);

/// Sets u from the variances of the lines that are counted; nullopt if none is.
void combine(UncertaintyBudget& budget);

}  // namespace stickslip::analysis
