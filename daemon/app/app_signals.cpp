// SIGTERM and SIGINT end the App; SIGHUP has another one take its place, with the configuration as it is
// then.

#include <signal.h>

#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/post.hpp>

#include "daemon/app/app.hpp"

namespace stickslip::app {

void App::wait_for_signal() {
  signals_.async_wait([this](boost::system::error_code error, int signal) {
    if (error) return;
    if (signal == SIGHUP) {
      reload();
    } else {
      reloads_ = false;
      stop(signal == SIGINT ? "SIGINT" : "SIGTERM");
    }
    wait_for_signal();
  });
}

void App::reload() {
  if (state_ == State::kStopping) return;
  if (const base::Result<void> good = world_.check_config(); !good) {
    world_.events->reload_refused(good.error().message);
    return;
  }
  if (std::exchange(reload_asked_, true)) return;
  world_.events->reload_waits();
  reload_when_idle();
}

void App::reload_when_idle() {
  if (state_ == State::kStopping) return;
  if (calibrations_.view().session) {
    look_again_for_reload();
    return;
  }
  runtime::Session* const session = session_.get();
  if (session == nullptr) {
    reload_now();
    return;
  }
  // Decided where tests begin: what is known here is known later.
  reload_at_rest_ = true;
  const bool asked = session->post([this, session](pipeline::Processor& processor) {
    if (pipeline::rests(processor.bench()) && reload_at_rest_.exchange(false)) reload_at_rest(*session);
  });
  // The session is over, and the board is waited for.
  if (!asked) look_again_for_reload();
}

void App::reload_at_rest(runtime::Session& session) {
  session.request_stop();
  boost::asio::post(io_, [this] { reload_now(); });
}

void App::reload_now() {
  if (state_ == State::kStopping) return;
  reloads_ = true;
  notify_.reloading();
  stop("to read the configuration again");
}

void App::look_again_for_reload() {
  constexpr std::chrono::seconds kLookAgain{1};
  reload_timer_.expires_after(kLookAgain);
  reload_timer_.async_wait([this](boost::system::error_code error) {
    if (!error) reload_when_idle();
  });
}

}  // namespace stickslip::app
