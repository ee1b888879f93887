#include "daemon/realtime.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <system_error>

namespace stickslip::daemon {

std::string use_realtime_scheduling(int priority) {
  if (priority == 0) return "SCHED_OTHER";
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return fmt::format("SCHED_FIFO {}", priority);
  return fmt::format("SCHED_OTHER (SCHED_FIFO {} refused: {})", priority,
                     std::generic_category().message(error));
}

}  // namespace stickslip::daemon
