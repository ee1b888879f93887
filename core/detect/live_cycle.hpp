/// \file
/// Live results of a running test: cycles, falls, phase and regime.
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

/// Estimator of S and K of a cycle, in the order of rising computing time (docs/accuracy.md).
enum class EstimatorTier {
  kTurningPoints,  ///< Closed forms of the turning points, from peak and trough interpolated between scans.
  kFit,            ///< Maximum likelihood of the closed form on all usable scans.
};

inline constexpr std::array<std::pair<EstimatorTier, std::string_view>, 2> kEstimatorTierNames{{
    {EstimatorTier::kTurningPoints, "turning-points"},
    {EstimatorTier::kFit, "fit"},
}};

/// Whether this is an estimator of version 0.1, "peak" or "interpolated", which mean "turning-points" now.
[[nodiscard]] constexpr bool is_former_estimator(std::string_view text) noexcept {
  return text == "peak" || text == "interpolated";
}

[[nodiscard]] constexpr std::string_view name(EstimatorTier tier) noexcept {
  for (const auto& [value, text] : kEstimatorTierNames) {
    if (value == tier) return text;
  }
  return "fit";
}

/// Estimator of this name; kTurningPoints for the names of version 0.1 (is_former_estimator()). Nullopt if
/// the name is unknown.
[[nodiscard]] constexpr std::optional<EstimatorTier> estimator_tier_from_name(
    std::string_view text) noexcept {
  if (is_former_estimator(text)) return EstimatorTier::kTurningPoints;
  for (const auto& [value, known] : kEstimatorTierNames) {
    if (known == text) return value;
  }
  return std::nullopt;
}

/// Phase of a test. Phases follow in this order, but kFirstSlip goes back to kLoading if the fall was no
/// slip; kEnd may follow any.
enum class Phase {
  kIdle,       ///< The force has not risen yet.
  kLoading,    ///< The force rises for the first time.
  kFirstSlip,  ///< The force has fallen; how a slip ended is not decided yet.
  kCycles,     ///< The end of at least one slip is decided.
  kEnd,        ///< LiveDetector::end() was called.
};

[[nodiscard]] constexpr std::string_view name(Phase phase) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"idle", "loading", "first-slip", "cycles", "end"};
  return kNames[static_cast<std::size_t>(phase)];
}

/// A cycle with its live estimates. NaN if unknown, as S and K of a slip that did not begin from sticking.
struct LiveCycle {
  Cycle cycle;
  double S = std::numeric_limits<double>::quiet_NaN();
  double K = std::numeric_limits<double>::quiet_NaN();
  /// Log-likelihood ratio of captured over free at the decision, or at the last test if there was none; 0 if
  /// it was too small to be computed (Budget::decisive).
  double evidence = std::numeric_limits<double>::quiet_NaN();
  /// When it was decided how the slip ended, less the despiker's delay; on the time axis of `cycle`. NaN if
  /// it was not.
  double decided_time_s = std::numeric_limits<double>::quiet_NaN();
};

/// A fall of the force at its detection; whether it is a slip is decided when it is over. LiveDetector counts
/// scans from the first one added, without those in gaps; TestAnalysis gives indices of the acquisition.
struct FallBegun {
  base::ScanIndex peak_scan = 0;  ///< Of the highest median of three scans.
  double peak = 0.0;              ///< That median.
  base::ScanIndex seen_scan = 0;  ///< Scan at which it was detected.
};

/// Present state of a test.
struct LiveState {
  Phase phase = Phase::kIdle;
  /// By the slip decided last: stick-slip, or ring-down, which becomes steady sliding when it has died away.
  /// Undecided until a slip is decided.
  model::Regime regime = model::Regime::kUndecided;
  std::int64_t slip_count = 0;      ///< Slips confirmed so far, with the one under way.
  std::optional<LiveCycle> latest;  ///< The cycle closed last.
};

}  // namespace stickslip::detect
