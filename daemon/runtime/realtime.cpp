#include "daemon/runtime/realtime.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace stickslip::runtime {
namespace {

/// Processor time that a SCHED_FIFO thread may use without blocking before SIGXCPU. The acquisition thread
/// needs most after a halt of the board, some 50 ms: it empties the kernel's buffer of a million scans in
/// 16000 reads.
constexpr rlim_t kLongestBurst_us = 1'000'000;
/// Processor time without blocking after which the kernel kills the process.
constexpr rlim_t kKillAfter_us = 2'000'000;

std::string error_text(int error) { return std::generic_category().message(error); }

/// \return 0 or errno.
int set_fifo(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  // 0 is the calling thread: the kernel's schedulers know threads only.
  return ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0 ? 0 : errno;
}

std::string use_fifo(int priority) {
  if (priority == 0) return "SCHED_OTHER";
  const int error = set_fifo(priority);
  if (error == 0) return fmt::format("SCHED_FIFO {}", priority);
  rlimit allowed{};
  if (::getrlimit(RLIMIT_RTPRIO, &allowed) == 0 && allowed.rlim_cur > 0 &&
      allowed.rlim_cur < static_cast<rlim_t>(priority)) {
    const auto lower = static_cast<int>(allowed.rlim_cur);
    if (set_fifo(lower) == 0)
      return fmt::format("SCHED_FIFO {} ({} refused: {})", lower, priority, error_text(error));
  }
  return fmt::format("SCHED_OTHER (SCHED_FIFO {} refused: {})", priority, error_text(error));
}

std::string use_processor(int processor) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<std::size_t>(processor), &only);
  // Returns the error; −1 is never one of them.
  const int error = ::pthread_setaffinity_np(::pthread_self(), sizeof only, &only);
  if (error == 0) return fmt::format("processor {}", processor);
  return fmt::format("any processor ({} refused: {})", processor, error_text(error));
}

/// Locks pages when they are first touched (MCL_ONFAULT). Locking all at once would load the untouched 8 MB
/// stack of each thread.
std::string lock_memory() {
  if (::mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return "memory locked";
  return fmt::format("memory not locked ({})", error_text(errno));
}

std::string limit_burst() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_RTTIME, &limit) != 0) return fmt::format("no RLIMIT_RTTIME ({})", error_text(errno));
  limit.rlim_cur = std::min(kLongestBurst_us, limit.rlim_max);
  limit.rlim_max = std::min(kKillAfter_us, limit.rlim_max);
  if (::setrlimit(RLIMIT_RTTIME, &limit) != 0) return fmt::format("no RLIMIT_RTTIME ({})", error_text(errno));
  return fmt::format("RLIMIT_RTTIME {:g} s", 1e-6 * static_cast<double>(limit.rlim_cur));
}

}  // namespace

std::string prepare_process(const io::RealtimeSettings& settings) {
  const std::string memory = settings.lock_memory ? lock_memory() : "memory not locked (not asked for)";
  return memory + ", " + limit_burst();
}

std::string use_realtime_scheduling(const io::RealtimeSettings& settings) {
  const std::string scheduling = use_fifo(settings.priority);
  return settings.processor ? scheduling + ", " + use_processor(*settings.processor) : scheduling;
}

std::string kernel_preemption() {
  std::ifstream file{"/sys/kernel/realtime"};
  int value = 0;
  return file >> value && value == 1 ? "PREEMPT_RT" : "standard";
}

}  // namespace stickslip::runtime
