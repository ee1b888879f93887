/// \file
/// Corrections that an analysis may leave out, to show their effect. They treat the three practical problems
/// of [Penner 1995, Experimental]: spikes, drift, and a first slip that is not representative.
///
///     AnalysisSettings settings;
///     settings.skipped = *skipped_from_text("spikes,drift");
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace stickslip::analysis {

/// Each flag that is true switches one correction off.
struct SkippedCorrections {
  bool spikes = false;  ///< Spikes stay in the trace; otherwise they are replaced, and fits leave them out.
  /// Fits keep the drift; otherwise, at constant pull speed, they subtract a significant one.
  bool drift = false;
  /// Means include the first slip and those after holds; otherwise only where there are too few others.
  bool first_slip = false;

  bool operator==(const SkippedCorrections&) const = default;
  [[nodiscard]] bool none() const { return *this == SkippedCorrections{}; }
};

struct CorrectionName {
  std::string_view name;
  bool SkippedCorrections::*flag;
};

/// Names in records and for `stickslip analyze --keep`.
inline constexpr std::array<CorrectionName, 3> kCorrectionNames{
    {{"spikes", &SkippedCorrections::spikes},
     {"drift", &SkippedCorrections::drift},
     {"first-slip", &SkippedCorrections::first_slip}}};

/// Union: each flag set in either.
[[nodiscard]] SkippedCorrections either(const SkippedCorrections& one,
                                        const SkippedCorrections& other) noexcept;

/// Names of the set flags, separated by commas, in the order of kCorrectionNames; empty if no flag is set.
[[nodiscard]] std::string text_of(const SkippedCorrections& skipped);

/// Inverse of text_of(), for names in any order; nullopt if a name is unknown.
[[nodiscard]] std::optional<SkippedCorrections> skipped_from_text(std::string_view text);

}  // namespace stickslip::analysis
