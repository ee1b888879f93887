/// \file
/// The named parts of a systematic uncertainty.
///
///     add_systematic(results.mu_s, UncertaintySource::kZero, offset);
///     results.mu_s.systematic_parts[UncertaintySource::kZero];   // what all calls for the zero gave
///     together
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
  kCreep,        ///< Creep of the contact before a slip that does not stick again.
  kMisfit,       ///< What differs from the fit alike in each slip.
  kRung,  ///< Distance to the result of another rung, of the slips' own fits, or of K to the mean force.
  kCorrection,  ///< By turning points: the whole correction for belt and damping.
  kBound,       ///< S − K is not told from zero: half of its bound.
};

inline constexpr std::size_t kUncertaintySourceCount = 9;

struct UncertaintySourceName {
  std::string_view name;   ///< In records and JSON.
  std::string_view title;  ///< In tables.
  /// Whether the part adds in quadrature to all before it. The others add as they are: their correlation is
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

/// Visits the parts in the order of the sources. \param visit  called as visit(UncertaintySource,
/// std::optional<double>&).
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

/// Adds parts to a systematic uncertainty: the only way to do so. Does nothing to an estimate without a
/// value. \param parts  of one place: what they make together is added at once.
void add_systematic(Estimate& estimate, std::initializer_list<UncertaintyPart> parts);
void add_systematic(Estimate& estimate, UncertaintySource source, double size);

/// Notes that this source is known to add nothing. The total stays as it is, also unknown.
void note_no_systematic(Estimate& estimate, UncertaintySource source);

/// The total that the parts make.
[[nodiscard]] double total_of(const SystematicParts& parts) noexcept;

/// What each part contributes to the systematic uncertainty; all together are that uncertainty. A part a of
/// those that add to M contributes a M/u, an independent part q of the total u contributes q²/u: the
/// contribution times u is the part's share of the variance u².
struct Contributions {
  std::array<double, kUncertaintySourceCount> of{};
  double unnamed = 0.0;  ///< The whole, where the parts are not known: records of older versions.
};

[[nodiscard]] Contributions contributions_of(const Estimate& estimate) noexcept;

}  // namespace stickslip::analysis
