/// \file
/// The axes of a sweep: keys of the scene and their values, as options state them.
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

/// Most points of a sweep; more are taken for a mistyped value.
inline constexpr std::int64_t kMostSweepPoints = 100'000;
/// Most runs of a sweep, with repetitions.
inline constexpr std::int64_t kMostSweepRuns = 1'000'000;

/// Reads an axis: KEY=FROM:TO:N, N ≥ 1 equidistant values (N = 1: FROM); KEY=log:FROM:TO:N, equidistant
/// logarithms, FROM and TO above 0; or KEY=a,b,c, numbers in one unit or words. A FROM without unit has that
/// of TO. Intermediate values are rounded to 15 digits. Errors: kUsage; the message begins with "--vary" and
/// the text.
[[nodiscard]] base::Result<record::SweepAxis> parse_axis(std::string_view text);

/// A value in the notation of scene files: "3 in/min", "0.34", "spring".
[[nodiscard]] std::string value_text(const record::SweepAxis& axis, std::size_t index);

/// Reads all axes, one from each option. Errors: kUsage if one is wrong, a key is repeated, or there are more
/// than kMostSweepPoints points or kMostSweepRuns runs. \param repeat  runs at each point.
[[nodiscard]] base::Result<std::vector<record::SweepAxis>> parse_axes(const std::vector<std::string>& options,
                                                                      std::int64_t repeat);

}  // namespace stickslip::sweep
