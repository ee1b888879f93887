/// \file
/// What may be kept in a test, to see what it does: the three practical problems of [Penner 1995,
/// Experimental], each of which the analysis takes care of unless it is told not to.
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

struct Kept {
  bool spikes = false;  ///< Spikes are scans like others; else they are replaced and left out of fits.
  bool drift = false;   ///< One K for the whole test; else a significant drift is taken off before the fits.
  bool first_slip = false;  ///< It counts in means like the others; else it does not where there are others.

  bool operator==(const Kept&) const = default;
  [[nodiscard]] bool nothing() const { return *this == Kept{}; }
};

struct KeptName {
  std::string_view name;
  bool Kept::*flag;
};

/// As in records and for `stickslip analyze --keep`.
inline constexpr std::array<KeptName, 3> kKeptNames{
    {{"spikes", &Kept::spikes}, {"drift", &Kept::drift}, {"first-slip", &Kept::first_slip}}};

/// What either keeps.
[[nodiscard]] Kept either(const Kept& one, const Kept& other) noexcept;

/// Names with commas between them, in the order of kKeptNames; empty if nothing is kept.
[[nodiscard]] std::string text_of(const Kept& kept);

/// Reads what text_of() wrote, in any order; nothing if a name is unknown.
[[nodiscard]] std::optional<Kept> kept_from_text(std::string_view text);

}  // namespace stickslip::analysis
