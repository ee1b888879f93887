/// \file
/// Accounts for every scan: how many were issued, discarded, lost and recorded. Each thread counts its own
/// part.
#pragma once

#include <cstdint>

namespace stickslip::daemon {

/// Scan counts since the daemon began. At the end of the program under_way() is 0; any other value is a
/// defect: scans were lost without a trace.
struct ScanAccount {
  /// Scan indices issued by the boards, of scans delivered or lost. Acquisition thread.
  std::int64_t issued = 0;
  std::int64_t idle = 0;  ///< Discarded between tests. Processing thread.
  /// Lost by board, ring or full disk, and recorded as gaps. Processing and disk thread.
  std::int64_t in_gaps = 0;
  std::int64_t recorded = 0;  ///< In records, or durable in journals that are not records yet. Disk thread.
  /// Durable in a journal, but unreadable when the record was made. Finisher's thread.
  std::int64_t damaged = 0;
  std::int64_t unsaved = 0;  ///< Never written, because the disk refused them to the end. Disk thread.

  /// Scans in queues, in a running test or in the buffer before a coming one. At the end of the program:
  /// scans unaccounted for.
  [[nodiscard]] std::int64_t under_way() const noexcept {
    return issued - idle - in_gaps - recorded - damaged - unsaved;
  }
};

}  // namespace stickslip::daemon
