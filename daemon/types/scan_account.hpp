/// \file
/// What became of each scan, counted by those who did it: the acquisition thread, the detector, the disk
/// thread.
#pragma once

#include <cstdint>

namespace stickslip::daemon {

/// Since the daemon began. At rest and at the end nothing is under way: then the issued indices are the sum
/// of all others, or the daemon has lost some and does not know where.
struct ScanAccount {
  std::int64_t issued = 0;  ///< Indices that the boards gave, of scans delivered or lost. Acquisition thread.
  std::int64_t idle = 0;    ///< Discarded between tests. Processing thread.
  std::int64_t in_gaps = 0;  ///< Lost by board, ring or a full disk, and told so. Processing and disk thread.
  std::int64_t recorded = 0;  ///< In records, or durable in journals that wait to become one. Disk thread.
  std::int64_t damaged =
      0;  ///< Durable once, and not to be read when the record was made. Finisher's thread.
  std::int64_t unsaved = 0;  ///< Of tests that the disk refused to the end. Disk thread.

  /// Of a running test, of the stretch before a coming one, or in a queue; at the end: unaccounted for.
  [[nodiscard]] std::int64_t under_way() const noexcept {
    return issued - idle - in_gaps - recorded - damaged - unsaved;
  }
};

}  // namespace stickslip::daemon
