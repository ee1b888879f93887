#include "daemon/fleet/fleet.hpp"

#include <algorithm>
#include <chrono>

#include "io/own_records.hpp"
#include "io/record_name.hpp"
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>

#include "daemon/fleet/backlog.hpp"
#include "daemon/fleet/messages.hpp"

namespace stickslip::fleet {
namespace {

/// Records whose results never reached the outbox; at most the latest by name that fit into it.
std::vector<std::filesystem::path> untold_records(Outbox& outbox, const io::FleetSettings& settings,
                                                  const std::filesystem::path& folder,
                                                  const base::Clock& wall) {
  const std::time_t now_s = wall.realtime_ns() / 1'000'000'000;
  auto untold = outbox.untold(io::own_records(folder), io::record_stem(now_s, 0));
  io::keep_last(untold, settings.outbox_results);
  return untold;
}

}  // namespace

Fleet::Fleet(boost::asio::io_context& io, const io::FleetSettings& settings, Parts parts)
    : io_(io),
      timer_(io),
      settings_(settings),
      parts_(std::move(parts)),
      told_facts_([&]() -> std::unique_ptr<ToldFacts> {
        if (!settings.facts_valid_s) return nullptr;
        return std::make_unique<ToldFacts>(io, settings.topic_of("facts"), *settings.facts_valid_s,
                                           parts_.set_facts, parts_.events);
      }()),
      publisher_([&] {
        Outbox outbox{settings.outbox, settings.outbox_results};
        auto untold = untold_records(outbox, settings, parts_.record_folder, parts_.wall);
        return FleetPublisher{settings, std::move(outbox), world(std::move(untold))};
      }()) {
  // Once the daemon runs: its status says more then.
  boost::asio::post(io_, [this] { tick(); });
}

FleetPublisher::World Fleet::world(std::vector<std::filesystem::path> untold) {
  std::reverse(untold.begin(), untold.end());
  return {.last_will = [this] { return last_will(settings_.tester, parts_.wall.realtime_ns()); },
          .backlog = [this, untold = std::move(untold)]() mutable -> std::optional<FleetResult> {
            while (!untold.empty()) {
              const std::filesystem::path record = std::move(untold.back());
              untold.pop_back();
              if (auto result = ask_result(parts_.program, settings_.tester, record)) return result;
            }
            return std::nullopt;
          },
          .changed = [this](const daemon::FleetState& state) { link_changed(state); },
          .facts = told_facts_ ? std::function<void(std::string)>{[this](std::string payload) {
            told_facts_->tell(std::move(payload));
          }}
                               : nullptr,
          .no_facts = [this](const std::string& why) { told_facts_->not_subscribed(why); }};
}

void Fleet::test_recorded(const record::RecordHeader& header, const record::EndRecord& end,
                          const std::filesystem::path& file) {
  publisher_.tell_result({file.stem().string(), header.uuid,
                          result_message(settings_.tester, result_json(header, end, end.cycles, file))});
}

void Fleet::state_changed() {
  const daemon::Status status = parts_.status();
  std::string now = state_message(settings_.tester, status, 0);
  if (now == told_) return;
  told_ = std::move(now);
  publisher_.tell_state(state_message(settings_.tester, status, parts_.wall.realtime_ns()));
}

void Fleet::bench_changed(pipeline::BenchState /*state*/) {
  if (on_the_way_.exchange(true)) return;
  boost::asio::post(io_, [this] {
    on_the_way_ = false;
    state_changed();
  });
}

void Fleet::link_changed(const daemon::FleetState& state) {
  using Link = daemon::FleetState::Link;
  if (state.link == Link::kConnecting) return;
  const bool connected = state.link == Link::kConnected;
  // A failure is reported once, not at each attempt.
  if (connected == was_connected_ && state.why == why_told_) return;
  was_connected_ = connected;
  why_told_ = state.why;
  parts_.events.fleet_changed(state);
}

void Fleet::tick() {
  publisher_.tell_health(health_message(settings_.tester, parts_.status(), parts_.wall.realtime_ns()));
  timer_.expires_after(std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::duration<double>(settings_.health_period_s)));
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error) tick();
  });
}

void Fleet::stop() {
  timer_.cancel();
  if (told_facts_) told_facts_->stop();
  publisher_.stop(state_message(settings_.tester, parts_.status(), parts_.wall.realtime_ns(), "stopped"));
}

}  // namespace stickslip::fleet
