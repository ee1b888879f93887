/// \file
/// Ctrl-C for commands that can stop in good order.
///
///     const StopOnSignals signals;
///     while (!signals.asked()) …
#pragma once

#include <atomic>
#include <csignal>

namespace stickslip::cli {

/// While it lives the first SIGINT or SIGTERM asks to stop; the next ends the program as ever. One at a time.
class StopOnSignals {
 public:
  StopOnSignals();
  ~StopOnSignals();
  StopOnSignals(const StopOnSignals&) = delete;
  StopOnSignals& operator=(const StopOnSignals&) = delete;

  [[nodiscard]] static const std::atomic<bool>& asked() noexcept;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace stickslip::cli
