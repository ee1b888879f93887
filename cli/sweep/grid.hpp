/// \file
/// The keys that a sweep varies, as options name them.
///
///     parse_axis("paper.mu_s=0.31:0.35:5")             → 0.31, 0.32, 0.33, 0.34, 0.35
///     parse_axis("accuracy=log:1e-9:1e-3:3")           → 1e-9, 1e-6, 1e-3
///     parse_axis("tester.sled_mass=500 g,2 kg")        → error: one unit for all
///     parse_axis("effects.onset_convention.force=spring,spring-and-damper")
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::sweep {

/// A value taken for a slip of the pen beyond.
inline constexpr std::int64_t kMostSweepPoints = 100'000;
inline constexpr std::int64_t kMostSweepRuns = 1'000'000;

/// KEY=FROM:TO:N, N ≥ 1 values evenly from FROM to TO (N = 1: FROM); KEY=log:FROM:TO:N, evenly in their
/// logarithms, FROM and TO above 0; or KEY=a,b,c, numbers in one unit or words. A FROM without unit has
/// that of TO. Values between are rounded to 15 digits, so that they read as they were meant.
/// Usage error that begins with "--vary" and the text.
[[nodiscard]] base::Result<record::SweepAxis> parse_axis(std::string_view text);

/// The value as a scene file has it: "3 in/min", "0.34", "spring".
[[nodiscard]] std::string value_text(const record::SweepAxis& axis, std::size_t index);

/// Every option an axis. Usage error: one of them is wrong, a key comes twice, more than kMostSweepPoints
/// points or, with the repetitions, kMostSweepRuns runs.
[[nodiscard]] base::Result<std::vector<record::SweepAxis>> parse_axes(const std::vector<std::string>& options,
                                                                      std::int64_t repeat);

}  // namespace stickslip::sweep
