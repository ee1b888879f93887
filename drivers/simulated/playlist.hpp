/// \file
/// Playlist: maps a scan index to the repetition of a scene. Board and truth both use it, without shared
/// mutable state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/scan_index.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::drivers {

/// One playing of one scene.
struct Repetition {
  std::int64_t number = 0;    ///< Among all repetitions played, from 0.
  std::size_t scene = 0;      ///< Index into Playlist::scenes().
  base::ScanIndex first = 0;  ///< Its first scan.
  std::int64_t count = 0;     ///< Its scans.
  std::uint64_t seed = 0;     ///< Of its random streams.

  [[nodiscard]] base::ScanIndex end() const noexcept { return first + count; }
};

/// Constant after construction, so thread-safe.
class Playlist {
 public:
  /// \param scenes   at least one, each with at least one scan at this rate.
  /// \param repeats  each scene is played so many times in a row; 0: the list is played round and
  ///                 round for ever.
  Playlist(std::vector<sim::Scene> scenes, int repeats, double scan_rate_Hz);

  [[nodiscard]] const std::vector<sim::Scene>& scenes() const noexcept { return scenes_; }
  [[nodiscard]] double scan_rate_Hz() const noexcept { return scan_rate_Hz_; }

  [[nodiscard]] bool has(std::int64_t repetition) const noexcept;
  /// \param number 0 …; has(number).
  [[nodiscard]] Repetition repetition(std::int64_t number) const noexcept;
  /// Number of the repetition that the scan belongs to; it may lie behind the end. \param scan ≥ 0.
  [[nodiscard]] std::int64_t repetition_of(base::ScanIndex scan) const noexcept;

 private:
  std::vector<sim::Scene> scenes_;
  int repeats_;
  double scan_rate_Hz_;
  std::vector<std::int64_t> counts_;           ///< Scans of one repetition of each scene.
  std::vector<base::ScanIndex> round_firsts_;  ///< First scan of each scene's turn in a round.
  std::int64_t round_count_ = 0;               ///< Scans of one round through the list.
};

}  // namespace stickslip::drivers
