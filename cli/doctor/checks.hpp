/// \file
/// Looks at an installation, from the configuration to the records: is everything there that a test needs,
/// and if not, what is to be done?
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/doctor/finding.hpp"
#include "io/config.hpp"

#include "core/base/clock.hpp"
#include "core/record/folder_probe.hpp"
#include "daemon/types/http.hpp"
#include "drivers/factory/factory.hpp"

namespace stickslip::doctor {

/// What is asked of the world; tests give their own.
struct DoctorWorld {
  std::function<base::Result<drivers::OpenedBoard>(const drivers::BoardConfig&, base::Clock&)> open_board;
  /// The daemon's answer to GET /v1/status.
  std::function<base::Result<daemon::HttpReply>(const std::filesystem::path& socket)> ask_status;
  std::function<bool()> clock_is_synchronised;
  /// Highest SCHED_FIFO priority, and bytes of memory that may be locked (nothing: all).
  std::function<int()> realtime_priority;
  std::function<std::optional<std::uint64_t>()> lockable_size;
  std::function<std::int64_t(const std::filesystem::path& folder)> room;  ///< Bytes; −1: not known.
  /// As record::probe_folder().
  std::function<base::Result<std::vector<record::FolderLack>>(const std::filesystem::path& folder)> probe;
  base::Clock* clock = nullptr;
};

/// That of this machine and this process. \param clock  outlives it.
[[nodiscard]] DoctorWorld this_world(base::Clock& clock);

/// In the order in which things are to be mended; each check gives one finding or more. Nothing stays
/// changed, nothing is acquired, no running daemon disturbed.
[[nodiscard]] std::vector<Finding> examine(const std::filesystem::path& configuration,
                                           const DoctorWorld& world);

}  // namespace stickslip::doctor
