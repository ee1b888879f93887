/// \file
/// What is known of a test while it runs.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/scan_index.hpp"
#include "core/detect/cycle.hpp"
#include "core/model/regime.hpp"

namespace stickslip::detect {

/// Where S and K of a cycle come from, by rising cost (docs/accuracy.md says how much).
enum class EstimatorTier {
  kPeak,          ///< Largest scan and mean: the tradition.
  kInterpolated,  ///< Peak and trough between the scans, and the closed forms of the turning points.
  kFit,           ///< Maximum likelihood of the closed form on all scans.
};

inline constexpr std::array<std::pair<EstimatorTier, std::string_view>, 3> kEstimatorTierNames{{
    {EstimatorTier::kPeak, "peak"},
    {EstimatorTier::kInterpolated, "interpolated"},
    {EstimatorTier::kFit, "fit"},
}};

[[nodiscard]] constexpr std::string_view name(EstimatorTier tier) noexcept {
  for (const auto& [value, text] : kEstimatorTierNames) {
    if (value == tier) return text;
  }
  return "fit";
}

[[nodiscard]] constexpr std::optional<EstimatorTier> estimator_tier_from_name(
    std::string_view text) noexcept {
  for (const auto& [value, known] : kEstimatorTierNames) {
    if (known == text) return value;
  }
  return std::nullopt;
}

/// How far a test has come. They follow one another; kEnd from any.
enum class Phase {
  kIdle,       ///< Nothing pulls yet.
  kLoading,    ///< The force rises for the first time.
  kFirstSlip,  ///< It fell, and how that ends is not known yet.
  kCycles,     ///< All after that.
  kEnd,
};

[[nodiscard]] constexpr std::string_view name(Phase phase) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"idle", "loading", "first-slip", "cycles", "end"};
  return kNames[static_cast<std::size_t>(phase)];
}

/// A cycle with what the live side alone tells of it. NaN where not known.
struct LiveCycle {
  Cycle cycle;
  double S = std::numeric_limits<double>::quiet_NaN();
  double K = std::numeric_limits<double>::quiet_NaN();
  /// Log of the likelihood ratio of captured over free that decided, or of what was known at the end.
  double evidence = std::numeric_limits<double>::quiet_NaN();
  double decided_time_s = std::numeric_limits<double>::quiet_NaN();  ///< When it was decided.
};

/// A fall of the force as soon as it is seen; whether it is a slip is known when it is over.
struct FallBegun {
  base::ScanIndex peak_scan = 0;  ///< Of the highest median of three scans.
  double peak = 0.0;              ///< That median.
  base::ScanIndex seen_scan = 0;  ///< The scan that showed it.
};

/// What holds at the moment.
struct LiveState {
  Phase phase = Phase::kIdle;
  model::Regime regime =
      model::Regime::kUndecided;  ///< Stick-slip, ring-down or steady sliding; undecided before the first.
  /// Onset, or peak where it is not known, of the slip that was not captured; NaN unless it rings down.
  double ring_down_since_s = std::numeric_limits<double>::quiet_NaN();
  std::int64_t slip_count = 0;
  std::optional<LiveCycle> latest;  ///< The cycle closed last.
};

}  // namespace stickslip::detect
