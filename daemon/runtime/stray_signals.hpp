/// \file
/// Signals that mean nothing to the daemon and whose default is to end it.
#pragma once

namespace stickslip::runtime {

/// From now on SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPIPE, SIGIO, SIGPWR, SIGSTKFLT and all
/// real-time signals are ignored, as long as nobody handles them already; programs that are started from here
/// ignore them too. SIGXFSZ as well: a limit to the size of files is then an error of writing (EFBIG).
void ignore_stray_signals();

}  // namespace stickslip::runtime
