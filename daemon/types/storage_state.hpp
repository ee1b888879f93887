/// \file
/// How it is with the room for records, for those who decide about tests and those who look.
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
    kShort,    ///< There is room for less than kLeastRoom_s of tests.
    kWaiting,  ///< The disk refuses, or the folder of the records is away; scans wait in memory.
  };
  Kind kind = Kind::kOk;
  std::optional<double>
      room_h;  ///< For how long there is room, scanning all the time; absent if nobody knows.
  std::size_t waiting_size = 0;  ///< Bytes in memory while the disk refuses.
  std::string why;               ///< For people; empty if all is well.
  std::string to_do;             ///< The same.
  /// What the file system of the records lacks, and what follows; for people.
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

/// Why a test that somebody asks for should not begin; nothing if it may. A test that the force begins is
/// recorded in any case: in memory, ten minutes at least.
[[nodiscard]] std::optional<std::string> why_no_test(const StorageState& storage);

}  // namespace stickslip::daemon
