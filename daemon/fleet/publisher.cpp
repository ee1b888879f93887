#include "daemon/fleet/publisher.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <utility>

namespace stickslip::fleet {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Most results in the buffer from other threads. It fills only while the thread is blocked by the disk, the
/// look-up of the broker's name or the reading of old records.
constexpr std::size_t kMostNews = 64;
/// Most results sent and not acknowledged; below Mosquitto's max_inflight_messages of 20.
constexpr std::size_t kMostInFlight = 16;
/// Longest pause between two attempts to connect.
constexpr milliseconds kLongestBrokerPause{30'000};
/// Longest wait for the broker to accept a connection.
constexpr milliseconds kConnectTime{10'000};
/// A connection that ends sooner counts as a failed attempt: the pauses go on growing.
constexpr milliseconds kWholeLife{10'000};
/// After so many short connections in a row the text names the likely cause, a second client of the same
/// name: Mosquitto 2.0.11 then ends the first one's connection without a reason.
constexpr int kSuspicious = 2;
/// Longest time that stop() lets a connection go on, of the 10 s that a stop of the daemon may take.
constexpr milliseconds kGrace{4'000};
/// Longest wait while connected: libmosquitto must be called once a second for its keep-alive.
constexpr milliseconds kIdleWait{1'000};
/// Longest wait while connecting: TLS does not tell which socket event it waits for.
constexpr milliseconds kImpatient{50};

}  // namespace

FleetPublisher::FleetPublisher(io::FleetSettings settings, Outbox outbox, World world)
    : settings_(std::move(settings)),
      world_(std::move(world)),
      outbox_(std::move(outbox)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  shown_.broker = settings_.broker_url;
  shown_.tester = settings_.tester;
  shown_.outbox_count = outbox_.results().size();
  thread_ = std::thread{[this] { run(); }};
}

FleetPublisher::~FleetPublisher() { stop({}); }

void FleetPublisher::wake() {
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_.get(), &one, sizeof one));
}

void FleetPublisher::tell_state(std::string payload) {
  {
    const std::lock_guard lock{mutex_};
    news_state_ = std::move(payload);
  }
  wake();
}

void FleetPublisher::tell_health(std::string payload) {
  {
    const std::lock_guard lock{mutex_};
    news_health_ = std::move(payload);
  }
  wake();
}

void FleetPublisher::tell_result(FleetResult result) {
  {
    const std::lock_guard lock{mutex_};
    if (news_results_.size() == kMostNews) {
      ++shown_.dropped_result_count;
      return;
    }
    news_results_.push_back(std::move(result));
  }
  wake();
}

daemon::FleetState FleetPublisher::state() const {
  const std::lock_guard lock{mutex_};
  return shown_;
}

void FleetPublisher::stop(std::string last_state) {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock{mutex_};
    if (!last_state.empty()) news_state_ = std::move(last_state);
    stopping_ = true;
    stop_at_ = Clock::now() + kGrace;
  }
  wake();
  thread_.join();
}

// The thread.

void FleetPublisher::run() {
  // OpenSSL writes without MSG_NOSIGNAL; here a broken connection is an error of write(), not an end.
  sigset_t pipe;
  ::sigemptyset(&pipe);
  ::sigaddset(&pipe, SIGPIPE);
  static_cast<void>(::pthread_sigmask(SIG_BLOCK, &pipe, nullptr));

  take_backlog();
  milliseconds pause = world_.first_retry;
  while (true) {
    const Time begun = Clock::now();
    const bool was_connected = connect_once();
    if (was_connected && Clock::now() - begun > kWholeLife) pause = world_.first_retry;
    const Time again = Clock::now() + pause;
    pause = std::min(2 * pause, kLongestBrokerPause);
    while (!stopping() && Clock::now() < again) {
      static_cast<void>(
          wait(-1, false, std::chrono::ceil<milliseconds>(again - Clock::now()) + milliseconds{1}));
      take_news();
    }
    if (stopping()) break;
  }
  take_news();
}

void FleetPublisher::take_backlog() {
  if (!world_.backlog) return;
  while (!stopping()) {
    auto result = world_.backlog();
    if (!result) return;
    accept(*std::move(result));
    take_news();
  }
}

bool FleetPublisher::connect_once() {
  set_link(daemon::FleetState::Link::kConnecting, state().why);
  connected_ = false;
  refusal_.clear();
  const auto ended = [this, begun = Clock::now()](const base::Error& why) {
    const bool was_connected = connected_;
    const bool was_short = was_connected && Clock::now() - begun < kWholeLife;
    short_lives_ = was_short ? short_lives_ + 1 : 0;
    connected_ = false;
    connection_.reset();
    in_flight_.clear();
    if (state_message_) state_due_ = true;
    state_message_.reset();
    set_link(daemon::FleetState::Link::kWaiting,
             short_lives_ < kSuspicious
                 ? why.message
                 : fmt::format("{} is another tester called {} as well?", why.message, settings_.tester));
    return was_connected;
  };
  const auto password = io::read_password(settings_.password_file);
  if (!password) return ended(password.error());
  const MqttTarget target{.host = settings_.broker.host,
                          .port = settings_.broker.port,
                          .tls = settings_.broker.tls,
                          .client = "stickslip-" + settings_.tester,
                          .user = settings_.user,
                          .password = *password,
                          .ca_file = settings_.ca_file,
                          .certificate_file = settings_.certificate_file,
                          .key_file = settings_.key_file};
  auto opened = MqttConnection::open(
      target, {settings_.topic_of("state"), world_.last_will(), 1, true},
      {.connected =
           [this] {
             connected_ = true;
             state_due_ = !state_.empty();  // The will may have been told in the meantime.
             facts_due_ = world_.facts != nullptr;
             set_link(daemon::FleetState::Link::kConnected, "");
           },
       .acknowledged = [this](int message, const std::string& refusal) { acknowledged(message, refusal); },
       .told = world_.facts,
       .not_subscribed = world_.no_facts});
  if (!opened) return ended(opened.error());
  connection_ = *std::move(opened);
  const base::Result<void> over = talk();
  return ended(over ? base::Error{base::ErrorKind::kFailure, "stopped"} : over.error());
}

base::Result<void> FleetPublisher::talk() {
  const Time connect_by = Clock::now() + kConnectTime;
  while (true) {
    take_news();
    if (connected_) {
      if (auto sent = send_due(); !sent) return sent;
    } else if (Clock::now() > connect_by) {
      return base::failure("no answer within {} s", kConnectTime.count() / 1000);
    }
    if (stopping() && (all_said() || Clock::now() > stop_at_)) {
      connection_->goodbye();
      static_cast<void>(connection_->serve(false, true));
      return {};
    }
    const auto [readable, writable] =
        wait(connection_->socket(), connection_->wants_write(), connected_ ? kIdleWait : kImpatient);
    if (auto served = connection_->serve(readable, writable); !served) return served;
    if (!refusal_.empty()) return base::failure("the broker refuses what it is told: {}", refusal_);
  }
}

bool FleetPublisher::all_said() const {
  return connected_ && !state_due_ && !state_message_ && outbox_.results().empty();
}

base::Result<void> FleetPublisher::send_due() {
  if (std::exchange(facts_due_, false)) {
    if (auto asked = connection_->subscribe(settings_.topic_of("facts")); !asked) return asked;
  }
  for (const FleetResult& result : outbox_.results()) {
    if (in_flight_.size() >= kMostInFlight) break;
    const bool sent_already = std::any_of(in_flight_.begin(), in_flight_.end(),
                                          [&result](const auto& one) { return one.second == result.id; });
    if (sent_already) continue;
    const auto sent = connection_->publish({settings_.topic_of("result"), result.payload, 1, false});
    if (!sent) return tl::unexpected(sent.error());
    in_flight_[*sent] = result.id;
  }
  // After the results, so that "stopped" does not come before the result of the test that was stopped.
  if (state_due_ && !state_message_) {
    const auto sent = connection_->publish({settings_.topic_of("state"), state_, 1, true});
    if (!sent) return tl::unexpected(sent.error());
    state_message_ = *sent;
    state_due_ = false;
  }
  if (health_) {
    const auto sent =
        connection_->publish({settings_.topic_of("health"), *std::exchange(health_, {}), 0, false});
    if (!sent) return tl::unexpected(sent.error());
  }
  return {};
}

void FleetPublisher::acknowledged(int message, const std::string& refusal) {
  const auto result = in_flight_.find(message);
  const bool is_state = state_message_ == message;
  if (!is_state && result == in_flight_.end()) return;
  if (!refusal.empty()) {
    refusal_ = refusal;
    return;
  }
  if (is_state) {
    state_message_.reset();
    return;
  }
  const bool was_here = outbox_.remove(result->second);
  in_flight_.erase(result);
  const std::lock_guard lock{mutex_};
  if (was_here) ++shown_.sent_result_count;  // Else it has been counted as dropped.
  shown_.outbox_count = outbox_.results().size();
  shown_.unsaved_result_count = outbox_.unsaved_count();
}

void FleetPublisher::take_news() {
  std::vector<FleetResult> results;
  {
    const std::lock_guard lock{mutex_};
    results.swap(news_results_);
    if (news_state_) {
      state_ = *std::exchange(news_state_, {});
      state_due_ = true;
    }
    if (news_health_) health_ = std::exchange(news_health_, {});
  }
  for (FleetResult& result : results) accept(std::move(result));
}

void FleetPublisher::accept(FleetResult result) {
  const Outbox::Added added = outbox_.add(std::move(result));
  const std::lock_guard lock{mutex_};
  if (added.dropped) ++shown_.dropped_result_count;
  shown_.outbox_count = outbox_.results().size();
  shown_.unsaved_result_count = outbox_.unsaved_count();
}

std::pair<bool, bool> FleetPublisher::wait(int socket, bool wants_write, milliseconds longest) {
  std::array<pollfd, 2> watched{
      {{wake_.get(), POLLIN, 0}, {socket, static_cast<short>(wants_write ? POLLIN | POLLOUT : POLLIN), 0}}};
  // Interrupted by a signal is as being woken for nothing.
  static_cast<void>(::poll(watched.data(), watched.size(), static_cast<int>(longest.count())));
  if ((watched[0].revents & POLLIN) != 0) {
    std::uint64_t count = 0;
    static_cast<void>(::read(wake_.get(), &count, sizeof count));
  }
  const bool broken = (watched[1].revents & (POLLERR | POLLHUP)) != 0;
  return {(watched[1].revents & POLLIN) != 0 || broken, (watched[1].revents & POLLOUT) != 0 || broken};
}

void FleetPublisher::set_link(daemon::FleetState::Link link, const std::string& why) {
  daemon::FleetState now;
  {
    const std::lock_guard lock{mutex_};
    if (shown_.link == link && shown_.why == why) return;
    shown_.link = link;
    shown_.why = why;
    now = shown_;
  }
  if (world_.changed && !stopping()) world_.changed(now);
}

bool FleetPublisher::stopping() const {
  const std::lock_guard lock{mutex_};
  return stopping_;
}

}  // namespace stickslip::fleet
