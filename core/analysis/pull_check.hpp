/// \file
/// Whether a force can be that of a sled which a belt pulls by a spring: a switched signal and a touch are
/// not.
#pragma once

#include <cstddef>
#include <optional>

#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Within which a jump rises.
inline constexpr std::size_t kJumpScans = 3;

/// What no pull does.
struct NoPull {
  bool is_brief = false;         ///< Loaded for a shorter time than any pull; else it jumped.
  double level = 0.0;            ///< Median of the first loaded scans.
  double loaded_s = 0.0;         ///< From the first of them to the last.
  std::size_t jump_at_scan = 0;  ///< The first loaded one of a jump.
  double overshoot = 0.0;        ///< How far the force then exceeded the level, over the level.
};

/// Nullopt for a pull, and for a trace that begins or ends under load or lies in the noise.
///
/// A jump: the force rises from below a quarter of its level L by more than L/2 within three scans, as a
/// switched signal does behind an anti-alias filter of a sixth of the scan rate, and three scans together
/// never exceed L by more than L/20. A spring that is stretched so fast gains r ≥ L/6 a scan; the sled, at
/// rest until the force reaches the level at which it slides, then lags behind the belt, and the force
/// overshoots by r/ω without damping and by r/(eω) with critical damping: by 0.078 L at
/// estimate::kFewScansACycle = 8, and by more with more scans.
///
/// A touch: less than 0.25 s lie between the first and the last scan above L/4.
[[nodiscard]] std::optional<NoPull> no_pull(const estimate::Trace& trace, double scan_rate_Hz);

}  // namespace stickslip::analysis
