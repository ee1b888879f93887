#include "daemon/runtime/stray_signals.hpp"

#include <csignal>
#include <initializer_list>

namespace stickslip::runtime {
namespace {

void ignore(int signal) {
  struct sigaction now {};
  // A profiler, for one, handles SIGPROF before main() begins.
  if (sigaction(signal, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) return;
  static_cast<void>(std::signal(signal, SIG_IGN));
}

}  // namespace

void ignore_stray_signals() {
  for (const int signal :
       {SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGPIPE, SIGIO, SIGPWR, SIGSTKFLT, SIGXFSZ})
    ignore(signal);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) ignore(signal);
}

}  // namespace stickslip::runtime
