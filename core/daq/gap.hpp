/// \file
/// Lost scans are data: a jump in the scan index becomes a Gap with its cause.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

enum class GapCause {
  kUnknown,       ///< The index jumped without a report.
  kOverrun,       ///< The board's buffer overflowed.
  kRingFull,      ///< The processing thread was too slow: the ring dropped whole blocks.
  kBoardMissing,  ///< The board was unplugged.
  kMissingScans,  ///< The source itself says that they are missing (a replayed gap).
  kStorageFull,   ///< They arrived; the disk refused them for longer than memory lasted.
  kDamaged,       ///< They were stored; the journal cannot be read where they stood.
};

[[nodiscard]] constexpr std::string_view name(GapCause cause) noexcept {
  switch (cause) {
    case GapCause::kUnknown:
      return "unknown";
    case GapCause::kOverrun:
      return "overrun";
    case GapCause::kRingFull:
      return "ring-full";
    case GapCause::kBoardMissing:
      return "board-missing";
    case GapCause::kMissingScans:
      return "missing-scans";
    case GapCause::kStorageFull:
      return "storage-full";
    case GapCause::kDamaged:
      return "damaged";
  }
  return "unknown";
}

/// Scans [first, first + count) did not arrive.
struct Gap {
  ScanIndex first = 0;
  std::int64_t count = 0;
  bool estimated = false;  ///< The board did not count them: the index after the gap comes from a clock.
  GapCause cause = GapCause::kUnknown;
};

/// Compares each block with the end of the one before.
class GapTracker {
 public:
  GapTracker() = default;
  /// \param next  where an acquisition before this one ended: the first block may have a gap then.
  explicit GapTracker(std::optional<ScanIndex> next) noexcept : next_(next) {}

  /// \param cause what to blame if there is a jump before this block.
  /// \param halted  the board had halted in between: the jump is an estimate, whatever else to blame.
  /// \return the gap before the block, if any. The first block ever never has one.
  [[nodiscard]] std::optional<Gap> observe(const ScanBlock& block, GapCause cause = GapCause::kUnknown,
                                           bool halted = false) noexcept {
    std::optional<Gap> gap;
    if (next_ && block.first > *next_) {
      const bool estimated = halted || cause == GapCause::kOverrun || cause == GapCause::kBoardMissing;
      gap = Gap{*next_, block.first - *next_, estimated, cause};
    }
    next_ = block.end();
    return gap;
  }

 private:
  std::optional<ScanIndex> next_;
};

}  // namespace stickslip::daq
