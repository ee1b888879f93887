/// \file
/// What the acquisition thread asks of the kernel, with a fall-back for each wish that is told, not hidden.
/// Without any of it scans are lost only if the machine is so busy that the board's own buffer overflows.
#pragma once

#include <string>

#include "io/config.hpp"

namespace stickslip::runtime {

/// Keeps what the process has touched and will touch in memory, and sets RLIMIT_RTTIME: a thread that runs
/// away under SCHED_FIFO is killed, not the machine. Call once, early. Needs RLIMIT_MEMLOCK or CAP_IPC_LOCK.
/// \return what is in force: "memory locked, RLIMIT_RTTIME 1 s".
[[nodiscard]] std::string prepare_process(const io::RealtimeSettings& settings);

/// Asks for SCHED_FIFO and the processor for the calling thread. Where RLIMIT_RTPRIO allows a lower priority,
/// that one. Children of the thread do not inherit it. \return what is in use: "SCHED_FIFO 50", "SCHED_FIFO
/// 20 (50 refused: Operation not permitted)",
///         "SCHED_OTHER (SCHED_FIFO 50 refused: …)", with ", processor 1" where one was asked for.
[[nodiscard]] std::string use_realtime_scheduling(const io::RealtimeSettings& settings);

/// What the kernel is: "PREEMPT_RT" or "standard".
[[nodiscard]] std::string kernel_preemption();

}  // namespace stickslip::runtime
