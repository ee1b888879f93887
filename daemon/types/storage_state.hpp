/// \file
/// State of the storage of records: room, trouble and remedy.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::daemon {

struct StorageState {
  enum class Kind {
    kOk,
    kShort,    ///< Room for less than kLeastRoom_s of scanning.
    kWaiting,  ///< Writing fails, or the record folder is away; scans wait in memory.
  };
  Kind kind = Kind::kOk;
  /// Hours of continuous scanning that the disk has room for; absent: unknown.
  std::optional<double> room_h;
  std::size_t waiting_size = 0;  ///< Bytes in memory while writing fails.
  std::string why;               ///< Reason, for people; empty if all is well.
  std::string to_do;             ///< Remedy, for people; empty if all is well.
  /// Features that the file system of the records lacks, each with the consequence; for people.
  std::vector<std::string> lacks;
};

[[nodiscard]] constexpr std::string_view name(StorageState::Kind kind) noexcept {
  switch (kind) {
    case StorageState::Kind::kOk:
      break;
    case StorageState::Kind::kShort:
      return "short";
    case StorageState::Kind::kWaiting:
      return "waiting";
  }
  return "ok";
}

/// Why a test must not be begun by command; nothing if it may. A test that the force begins is recorded in
/// any case: memory holds at least ten minutes.
[[nodiscard]] std::optional<std::string> why_no_test(const StorageState& storage);

}  // namespace stickslip::daemon
