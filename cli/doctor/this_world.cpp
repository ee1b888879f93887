#include <sys/resource.h>
#include <sys/timex.h>
#include <unistd.h>

#include "cli/doctor/checks.hpp"

#include "core/record/file_calls.hpp"
#include "daemon/client/client.hpp"

namespace stickslip::doctor {
namespace {

/// Longest wait for the daemon's reply.
constexpr std::chrono::milliseconds kTimeout{5000};

/// True for root, whom the resource limits do not restrict.
bool is_root() { return ::geteuid() == 0; }

constexpr int kHighestPriority = 99;

}  // namespace

DoctorWorld this_world(base::Clock& clock) {
  DoctorWorld world;
  world.open_board = [](const drivers::BoardConfig& board, base::Clock& time) {
    return drivers::open_board(board, time);
  };
  world.ask_status = [](const std::filesystem::path& socket) {
    return client::request(socket, {"GET", "/v1/status", {}, {}, {}}, kTimeout);
  };
  world.clock_is_synchronised = [] {
    timex facts{};
    return ::adjtimex(&facts) != TIME_ERROR && (facts.status & STA_UNSYNC) == 0;
  };
  world.realtime_priority = [] {
    rlimit limit{};
    if (is_root()) return kHighestPriority;
    return ::getrlimit(RLIMIT_RTPRIO, &limit) == 0 ? static_cast<int>(limit.rlim_cur) : 0;
  };
  world.lockable_size = []() -> std::optional<std::uint64_t> {
    rlimit limit{};
    if (is_root() || ::getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
      return std::nullopt;
    return limit.rlim_cur;
  };
  world.room = [](const std::filesystem::path& folder) {
    return record::system_calls().room(folder.c_str());
  };
  world.probe = [](const std::filesystem::path& folder) { return record::probe_folder(folder); };
  world.clock = &clock;
  return world;
}

}  // namespace stickslip::doctor
