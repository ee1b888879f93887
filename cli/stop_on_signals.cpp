#include "cli/stop_on_signals.hpp"

namespace stickslip::cli {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "else no signal handler may touch it");

extern "C" void ask_to_stop(int /*signal*/) { stop_asked.store(true); }

}  // namespace

StopOnSignals::StopOnSignals() {
  stop_asked.store(false);
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = static_cast<int>(static_cast<unsigned>(SA_RESTART) | static_cast<unsigned>(SA_RESETHAND));
  ::sigaction(SIGINT, &action, &old_interrupt_);
  ::sigaction(SIGTERM, &action, &old_terminate_);
}

StopOnSignals::~StopOnSignals() {
  ::sigaction(SIGINT, &old_interrupt_, nullptr);
  ::sigaction(SIGTERM, &old_terminate_, nullptr);
}

const std::atomic<bool>& StopOnSignals::asked() noexcept { return stop_asked; }

}  // namespace stickslip::cli
