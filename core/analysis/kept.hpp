/// \file
/// Corrections that an analysis may leave out, to show their effect. They treat the three practical problems
/// of [Penner 1995, Experimental]: spikes, drift, and a first slip that is not representative.
///
///     AnalysisSettings settings;
///     settings.kept = *kept_from_text("spikes,drift");
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace stickslip::analysis {

/// Each flag that is true switches one correction off.
struct Kept {
  bool spikes = false;  ///< Spikes stay in the trace; otherwise they are replaced, and fits leave them out.
  bool drift = false;   ///< Drift stays; otherwise a significant drift is subtracted before the fits.
  bool first_slip = false;  ///< Means include the first slip; otherwise only if it is the only one.

  bool operator==(const Kept&) const = default;
  [[nodiscard]] bool nothing() const { return *this == Kept{}; }
};

struct KeptName {
  std::string_view name;
  bool Kept::*flag;
};

/// Names in records and for `stickslip analyze --keep`.
inline constexpr std::array<KeptName, 3> kKeptNames{
    {{"spikes", &Kept::spikes}, {"drift", &Kept::drift}, {"first-slip", &Kept::first_slip}}};

/// Union: each flag set in either.
[[nodiscard]] Kept either(const Kept& one, const Kept& other) noexcept;

/// Names of the set flags, separated by commas, in the order of kKeptNames; empty if no flag is set.
[[nodiscard]] std::string text_of(const Kept& kept);

/// Inverse of text_of(), for names in any order; nullopt if a name is unknown.
[[nodiscard]] std::optional<Kept> kept_from_text(std::string_view text);

}  // namespace stickslip::analysis
