/// \file
/// The description from which a test's S, K and S − K come: the highest rung of a ladder that fits the trace.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace stickslip::analysis {

enum class Rung {
  kNone,             ///< No S and K: no slip, too few scans, or scans that void the results.
  kTurningPoints,    ///< Peaks and troughs of the cycles; wherever there are slips.
  kTwoParameterLaw,  ///< Fit with constant S and K; γ is held: the tester's, or a typical one.
  kLawWithSlope,  ///< Fit with a free γ, which includes the slope of K with speed: γ = γ_tester + g μ′.
};

inline constexpr std::array<std::pair<Rung, std::string_view>, 4> kRungNames{{
    {Rung::kNone, "none"},
    {Rung::kTurningPoints, "turning-points"},
    {Rung::kTwoParameterLaw, "two-parameter-law"},
    {Rung::kLawWithSlope, "law-with-slope"},
}};

[[nodiscard]] constexpr std::string_view name(Rung rung) noexcept {
  for (const auto& [value, text] : kRungNames) {
    if (value == rung) return text;
  }
  return "none";
}

[[nodiscard]] constexpr std::optional<Rung> rung_from_name(std::string_view text) noexcept {
  for (const auto& [value, known] : kRungNames) {
    if (known == text) return value;
  }
  return std::nullopt;
}

}  // namespace stickslip::analysis
