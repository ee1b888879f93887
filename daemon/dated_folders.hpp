/// \file
/// Where records stand.
#pragma once

namespace stickslip::daemon {

/// In which folders below the one of the records a file stands, by the date of its start, UTC.
enum class DatedFolders {
  kNone,
  kMonth,  ///< 2026/11
  kDay,    ///< 2026-11-21
};

/// Folders below the one of the records in which records stand: years and months, or days.
inline constexpr int kDeepestRecordFolder = 2;

}  // namespace stickslip::daemon
