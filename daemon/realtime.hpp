/// \file
/// Scheduling of the acquisition thread, with a fall-back that is told, not hidden.
#pragma once

#include <string>

namespace stickslip::daemon {

/// Asks for SCHED_FIFO for the calling thread. Without the permission (RLIMIT_RTPRIO or
/// CAP_SYS_NICE) the thread goes on as it is: scans are then lost only if the machine is so
/// busy that the board's own buffer overflows.
/// \param priority  1 … 99; 0 does not ask.
/// \return what is in use, for the log and the record: "SCHED_FIFO 50", or
///         "SCHED_OTHER (SCHED_FIFO 50 refused: Operation not permitted)".
[[nodiscard]] std::string use_realtime_scheduling(int priority);

}  // namespace stickslip::daemon
