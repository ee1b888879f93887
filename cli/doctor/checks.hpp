/// \file
/// Checks of `stickslip doctor`: from the configuration to the records, whether an installation has all that
/// a test needs, and how to repair it.
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

/// The dependencies of the checks; tests replace them.
struct DoctorWorld {
  std::function<base::Result<drivers::OpenedBoard>(const drivers::BoardConfig&, base::Clock&)> open_board;
  /// Returns the daemon's reply to GET /v1/status.
  std::function<base::Result<daemon::HttpReply>(const std::filesystem::path& socket)> ask_status;
  std::function<bool()> clock_is_synchronised;
  /// Highest permitted SCHED_FIFO priority; and permitted bytes of locked memory (nothing: unlimited).
  std::function<int()> realtime_priority;
  std::function<std::optional<std::uint64_t>()> lockable_size;
  std::function<std::int64_t(const std::filesystem::path& folder)> room;  ///< Free bytes; −1: unknown.
  /// As record::probe_folder().
  std::function<base::Result<std::vector<record::FolderLack>>(const std::filesystem::path& folder)> probe;
  base::Clock* clock = nullptr;
};

/// The dependencies on the real machine. \param clock  outlives the result.
[[nodiscard]] DoctorWorld this_world(base::Clock& clock);

/// Runs all checks, each of which gives one finding or more, in the order of repair. They leave nothing
/// changed, acquire no scans and do not disturb a running daemon.
[[nodiscard]] std::vector<Finding> examine(const std::filesystem::path& configuration,
                                           const DoctorWorld& world);

}  // namespace stickslip::doctor
