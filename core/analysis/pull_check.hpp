/// \file
/// Whether a force can be that of a sled which a belt pulls by a spring. That of a switched signal or of a
/// touch cannot.
#pragma once

#include <cstddef>
#include <optional>

#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Scans within which a jump rises.
inline constexpr std::size_t kJumpScans = 3;

/// Why a force is not that of a pulled sled. A scan is loaded from a quarter of the largest force on; the
/// largest force is that of the medians of three scans.
struct NoPull {
  bool is_brief = false;         ///< Loaded for a shorter time than any pull; else it jumped.
  double level = 0.0;            ///< Median of the first 16 384 loaded scans, as a coefficient.
  double loaded_s = 0.0;         ///< From the first loaded scan to the last.
  std::size_t jump_at_scan = 0;  ///< Scan after the one from which it jumped; 0 if brief.
  double overshoot = 0.0;        ///< Largest force over the level, less 1.
};

/// Why the force cannot be that of a pull: it jumped, or was a touch. Nullopt for a pull, and for a trace
/// that begins under load, ends under load or fewer than five scans after it, or lies in the noise.
///
/// A jump: the force rises from below a quarter of NoPull::level, L, by L/2 or more within three scans, as a
/// switched signal does behind an anti-alias filter of a sixth of the scan rate, and the median of three
/// neighbouring scans never exceeds L by more than L/20. A spring that is stretched so fast gains r ≥ L/6 a
/// scan. The sled, at rest until the force reaches the level at which it slides, then lags behind the belt,
/// and the force overshoots by r/ω without damping and by r/(eω) with critical damping: by 0.078 L at
/// estimate::kFewScansACycle = 8, and by more with more scans.
///
/// A touch: less than 0.25 s lie between the first and the last loaded scan.
[[nodiscard]] std::optional<NoPull> no_pull(const estimate::Trace& trace, double scan_rate_Hz);

}  // namespace stickslip::analysis
