/// \file
/// The named parts of a systematic uncertainty.
///
///     add_systematic(results.mu_s, UncertaintySource::kZero, offset);
///     results.mu_s.systematic_parts[UncertaintySource::kZero];   // of all calls for the zero together
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

namespace stickslip::analysis {

struct Estimate;

/// What makes a systematic uncertainty.
enum class UncertaintySource : std::uint8_t {
  kCalibration,  ///< Gain of the load cell.
  kZero,         ///< Reading of the unloaded load cell.
  kClock,        ///< Quartz of the computer.
  kDamping,      ///< Whether the damper's force counts at the onset; a damping that is held.
  kCreep,        ///< Creep of the contact before the slips, where none of a section ends in sticking.
  kMisfit,       ///< What differs from the fit alike in each slip.
  kRung,  ///< Distance to the result of another rung or of the slips' own fits, or from K to the mean force.
  kCorrection,  ///< By turning points: the whole correction for belt and damping.
  kBound,       ///< S − K is not told from zero: half of its bound.
};

inline constexpr std::size_t kUncertaintySourceCount = 9;

struct UncertaintySourceName {
  std::string_view name;   ///< In records and JSON.
  std::string_view title;  ///< In tables.
  /// Whether the part adds in quadrature to the total. The others add as they are: their correlation is
  /// not known, and fully correlated parts give the largest total [JCGM 100:2008, 5.2.2 note 1].
  bool is_independent;
};

[[nodiscard]] const UncertaintySourceName& name_of(UncertaintySource source) noexcept;

/// Size of each part; nullopt: no such part, or it is not known. 0: it is known to be none.
class SystematicParts {
 public:
  [[nodiscard]] std::optional<double>& operator[](UncertaintySource source) noexcept {
    return sizes_[static_cast<std::size_t>(source)];
  }
  [[nodiscard]] const std::optional<double>& operator[](UncertaintySource source) const noexcept {
    return sizes_[static_cast<std::size_t>(source)];
  }
  bool operator==(const SystematicParts&) const = default;

 private:
  std::array<std::optional<double>, kUncertaintySourceCount> sizes_{};
};

/// Visits the parts in the order of the sources, also those that are nullopt. \param visit  called as
/// visit(UncertaintySource, std::optional<double>&), const for const parts.
template <typename Parts, typename Visitor>
void for_each_part(Parts& parts, Visitor&& visit) {
  for (std::size_t i = 0; i < kUncertaintySourceCount; ++i) {
    const auto source = static_cast<UncertaintySource>(i);
    visit(source, parts[source]);
  }
}

struct UncertaintyPart {
  UncertaintySource source;
  double size;  ///< In the unit of the estimate; its sign does not matter.
};

/// Adds parts to those of the estimate and to its total: independent ones in quadrature, then the sum of the
/// others as it is. A part that is there already grows by the same rule. Add independent parts last, in calls
/// of their own: only then the total is total_of() the parts. Does nothing to an estimate without a value.
void add_systematic(Estimate& estimate, std::initializer_list<UncertaintyPart> parts);
void add_systematic(Estimate& estimate, UncertaintySource source, double size);

/// Sets this source's part to 0, known to add nothing, if the estimate has a value and no such part yet. The
/// total, known or not, does not change.
void note_no_systematic(Estimate& estimate, UncertaintySource source);

/// Total of the parts: the sum of those that are not independent, and the others in quadrature; 0 if none.
[[nodiscard]] double total_of(const SystematicParts& parts) noexcept;

/// What each part contributes to the systematic uncertainty u; the contributions add to u. With M the sum of
/// the parts that are not independent, such a part a contributes a M/u, and an independent part q contributes
/// q²/u: the contribution times u is the part's share of the variance u².
struct Contributions {
  std::array<double, kUncertaintySourceCount> of{};
  /// u, where the parts do not make it, as in records of older versions: then `of` is 0.
  double unnamed = 0.0;
};

/// All 0 if u is unknown, 0 or NaN.
[[nodiscard]] Contributions contributions_of(const Estimate& estimate) noexcept;

}  // namespace stickslip::analysis
