/// \file
/// Gap: consecutive scans that are missing, with the cause. GapTracker finds gaps from jumps of the scan
/// index. The journal adds those of scans that it could not store or cannot read, an import those of rows
/// that its trace lacks.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/daq/scan_block.hpp"

namespace stickslip::daq {

enum class GapCause {
  kUnknown,       ///< The index jumped without a report.
  kOverrun,       ///< The board's buffer overflowed, and the board halted.
  kRingFull,      ///< The processing thread was too slow: the ring dropped whole blocks.
  kBoardMissing,  ///< The board was gone (unplugged or silent) or failed, and was opened again.
  kSuspended,     ///< The computer was suspended.
  kMissingScans,  ///< An imported trace has no rows for these scans.
  kStorageFull,   ///< The scans arrived; writing failed for longer than memory could hold them.
  kDamaged,       ///< The scans were stored; that part of the journal is unreadable.
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
    case GapCause::kSuspended:
      return "suspended";
    case GapCause::kMissingScans:
      return "missing-scans";
    case GapCause::kStorageFull:
      return "storage-full";
    case GapCause::kDamaged:
      return "damaged";
  }
  return "unknown";
}

/// Scans [first, first + count) are missing.
struct Gap {
  ScanIndex first = 0;
  std::int64_t count = 0;
  bool estimated = false;  ///< The count comes from a clock, not from the board.
  GapCause cause = GapCause::kUnknown;
};

/// Finds gaps by comparing each block with the end of the one before.
class GapTracker {
 public:
  GapTracker() = default;
  /// \param next  index expected of the first block, the end of an earlier acquisition; nullopt: any.
  explicit GapTracker(std::optional<ScanIndex> next) noexcept : next_(next) {}

  /// Takes the next block.
  /// \param block  not empty.
  /// \param cause  cause of the gap if the index jumps before this block. With kOverrun, kBoardMissing and
  ///        kSuspended the gap is estimated.
  /// \param halted  the board had halted in between; the gap is then estimated, whatever the cause.
  /// \return the gap before the block, if any; none before the first block, unless its index was expected.
  [[nodiscard]] std::optional<Gap> observe(const ScanBlock& block, GapCause cause = GapCause::kUnknown,
                                           bool halted = false) noexcept {
    std::optional<Gap> gap;
    if (next_ && block.first > *next_) {
      const bool estimated = halted || cause == GapCause::kOverrun || cause == GapCause::kBoardMissing ||
                             cause == GapCause::kSuspended;
      gap = Gap{*next_, block.first - *next_, estimated, cause};
    }
    next_ = block.end();
    return gap;
  }

 private:
  std::optional<ScanIndex> next_;
};

}  // namespace stickslip::daq
