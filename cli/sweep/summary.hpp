/// \file
/// A sweep in a few numbers for each point: what was measured there, and how far from the truth.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/model/regime.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::sweep {

/// Measured minus true, over the runs that have both.
struct SweepError {
  std::int64_t count = 0;
  double mean = 0.0;                ///< NaN without a run.
  double standard_deviation = 0.0;  ///< Of a single run; NaN with fewer than two.
};

/// The results whose errors are summed up.
inline constexpr std::array<std::string_view, 5> kJudgedResults{"delta_mu", "mu_s", "mu_k",
                                                                "static_coefficient", "kinetic_coefficient"};

struct PointSummary {
  std::int64_t run_count = 0;
  std::array<std::int64_t, model::kRegimeNames.size()> regimes{};  ///< Runs measured as each.
  std::int64_t regime_right = 0;                                   ///< Runs whose regime is the true one.
  std::array<SweepError, kJudgedResults.size()> errors{};
};

/// Runs [first, first + count).
[[nodiscard]] PointSummary summary_of(const record::SweepTable& table, std::int64_t first,
                                      std::int64_t count);

/// A line for each point, or, where these would be too many, a map of the regimes over two axes, and one
/// line for all.
[[nodiscard]] std::string sweep_table_text(const record::SweepFacts& facts, const record::SweepTable& table);

/// [{"values": {key: value}, "run_count", "regimes": {name: share}, "regime_right": share, "errors": {result:
/// {"count", "mean", "standard_deviation"}}}]
[[nodiscard]] nlohmann::ordered_json sweep_points_json(const record::SweepFacts& facts,
                                                       const record::SweepTable& table);

}  // namespace stickslip::sweep
