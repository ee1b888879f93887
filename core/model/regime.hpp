/// \file
/// Regime of a pull: stick-slip, ring-down, mixed, inertial oscillation, steady sliding, undecided.
/// Slips whose end is not told do not count. Definitions: docs/glossary.md.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace stickslip::model {

enum class Regime {
  kStickSlip,            ///< Every slip of the pull ended in sticking.
  kRingDown,             ///< No slip ended in sticking: one decaying oscillation.
  kMixed,                ///< At least one of each.
  kInertialOscillation,  ///< No slip ended in sticking, and the oscillation does not decay: friction feeds
                         ///< it.
  kSteadySliding,        ///< No oscillation.
  kUndecided,            ///< The data do not tell.
};

inline constexpr std::array<std::pair<Regime, std::string_view>, 6> kRegimeNames{{
    {Regime::kStickSlip, "stick-slip"},
    {Regime::kRingDown, "ring-down"},
    {Regime::kMixed, "mixed"},
    {Regime::kInertialOscillation, "inertial-oscillation"},
    {Regime::kSteadySliding, "steady-sliding"},
    {Regime::kUndecided, "undecided"},
}};

[[nodiscard]] constexpr std::string_view name(Regime regime) noexcept {
  for (const auto& [value, text] : kRegimeNames) {
    if (value == regime) return text;
  }
  return "undecided";
}

[[nodiscard]] constexpr std::optional<Regime> regime_from_name(std::string_view text) noexcept {
  for (const auto& [value, known] : kRegimeNames) {
    if (known == text) return value;
  }
  return std::nullopt;
}

}  // namespace stickslip::model
