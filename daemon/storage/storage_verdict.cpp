#include "daemon/storage/storage_verdict.hpp"

#include <fmt/format.h>

namespace stickslip::storage {

daemon::StorageState storage_state(const DiskState& disk, const std::filesystem::path& folder) {
  daemon::StorageState state;
  state.room_h = disk.room_h;
  if (disk.trouble) {
    state.kind = daemon::StorageState::Kind::kWaiting;
    state.waiting_size = disk.waiting_size;
    const bool is_away = !disk.to_do.empty();
    state.why = fmt::format("{}, {} kB wait in memory: {}",
                            is_away ? "the folder of the records is away" : "the disk refuses",
                            disk.waiting_size / 1000, *disk.trouble);
    state.to_do =
        fmt::format("{}; memory holds ten minutes of scans, and they are written as soon as {}",
                    is_away ? disk.to_do : fmt::format("make room in {} or mend its disk", folder.string()),
                    is_away ? "it is back" : "the disk takes them");
  } else if (disk.is_short) {
    constexpr double kMinutesPerHour = 60.0;
    state.kind = daemon::StorageState::Kind::kShort;
    state.why = fmt::format("room for {:.0f} min of tests, {:.0f} are wanted",
                            disk.room_h.value_or(0.0) * kMinutesPerHour, kLeastRoom_s / kMinutesPerHour);
    state.to_do = fmt::format("move records from {} to another disk, or give it more room", folder.string());
  }
  return state;
}

}  // namespace stickslip::storage
