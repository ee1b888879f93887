/// \file
/// Real-time settings of process and acquisition thread. Each function falls back if the kernel refuses, and
/// returns what is in force. Without them, scans are lost only if the machine is so busy that the board's
/// buffer overflows.
#pragma once

#include <string>

#include "io/config.hpp"

namespace stickslip::runtime {

/// Locks present and future memory of the process, if asked for, and sets RLIMIT_RTTIME, so that a SCHED_FIFO
/// thread in an endless loop is killed and does not block the machine. Call it once, early. Locking needs
/// RLIMIT_MEMLOCK or CAP_IPC_LOCK. \return what is in force: "memory locked, RLIMIT_RTTIME 1 s".
[[nodiscard]] std::string prepare_process(const io::RealtimeSettings& settings);

/// Sets SCHED_FIFO and the processor for the calling thread. If RLIMIT_RTPRIO allows only a lower priority,
/// uses that. Children of the thread do not inherit it. \return what is in use: "SCHED_FIFO 50", "SCHED_FIFO
/// 20 (50 refused: Operation not permitted)",
///         "SCHED_OTHER (SCHED_FIFO 50 refused: …)", with ", processor 1" where one was asked for.
[[nodiscard]] std::string use_realtime_scheduling(const io::RealtimeSettings& settings);

/// Kind of kernel: "PREEMPT_RT" or "standard".
[[nodiscard]] std::string kernel_preemption();

}  // namespace stickslip::runtime
