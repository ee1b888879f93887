/// \file
/// Ignores signals that the daemon does not use and whose default action would end it.
#pragma once

namespace stickslip::runtime {

/// Ignores SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPIPE, SIGIO, SIGPWR, SIGSTKFLT, SIGXFSZ and all
/// real-time signals, unless they have a handler. Child processes inherit this. Without SIGXFSZ, a file above
/// the size limit is a write error (EFBIG).
void ignore_stray_signals();

}  // namespace stickslip::runtime
