#include "daemon/fleet/told_facts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <boost/asio/post.hpp>

#include "daemon/types/plan_json.hpp"

namespace stickslip::fleet {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongest = 65'536;  ///< Bytes of a message.
constexpr std::size_t kMostWaiting = 16;
/// Facts told at a time: a record has room for these and for those of the plan.
constexpr std::size_t kMostTold = 20;
constexpr std::size_t kMostRefusals = 8;

}  // namespace

ToldFacts::ToldFacts(boost::asio::io_context& io, std::string topic, double valid_s, Changed changed,
                     daemon::EventReceiver& events)
    : io_(io),
      timer_(io),
      topic_(std::move(topic)),
      valid_(valid_s),
      changed_(std::move(changed)),
      events_(events) {}

void ToldFacts::tell(std::string payload) {
  const std::size_t size = payload.size();
  std::size_t waiting = 0;
  if (size <= kLongest) {
    const std::lock_guard lock{mutex_};
    waiting = waiting_.size();
    if (waiting < kMostWaiting) waiting_.push_back(std::move(payload));
  }
  if (size > kLongest || waiting == kMostWaiting) {
    std::string why = size > kLongest
                          ? fmt::format("a message of {} bytes; send at most {}", size, kLongest)
                          : fmt::format("messages come too fast, {} wait; send fewer", kMostWaiting);
    return boost::asio::post(io_, [this, why = std::move(why)] { refuse(why); });
  }
  // The first of those that wait calls for all.
  if (waiting == 0) boost::asio::post(io_, [this] { take_waiting(); });
}

void ToldFacts::not_subscribed(const std::string& why) {
  boost::asio::post(io_, [this, why] {
    refuse(
        fmt::format("the broker refuses the subscription ({}): give this tester's user the right to read "
                    "the topic",
                    why));
  });
}

void ToldFacts::take_waiting() {
  std::vector<std::string> payloads;
  {
    const std::lock_guard lock{mutex_};
    payloads.swap(waiting_);
  }
  for (const std::string& payload : payloads) take(payload);
  changed_(facts());
  wait_for_the_oldest();
}

void ToldFacts::take(const std::string& payload) {
  const auto told = daemon::facts_in(payload);
  if (!told) return refuse(told.error().message);
  std::map<std::string, Fact> now = facts_;
  const Time until = Clock::now() + std::chrono::duration_cast<Clock::duration>(valid_);
  for (const auto& [key, value] : *told) {
    if (value.empty()) {
      now.erase(key);
    } else {
      now.insert_or_assign(key, Fact{value, until});
    }
  }
  if (now.size() > kMostTold)
    return refuse(fmt::format("{} facts, at most {} are taken: tell fewer", now.size(), kMostTold));
  facts_ = std::move(now);
  refusals_.clear();
}

void ToldFacts::forget_old() {
  std::string keys;
  for (const auto& [key, fact] : facts_) {
    if (fact.until <= Clock::now()) keys += (keys.empty() ? "" : ", ") + key;
  }
  std::erase_if(facts_, [](const auto& fact) { return fact.second.until <= Clock::now(); });
  if (!keys.empty()) {
    changed_(facts());
    events_.facts_expired(topic_, keys, valid_.count());
  }
  wait_for_the_oldest();
}

void ToldFacts::wait_for_the_oldest() {
  const auto oldest = std::min_element(facts_.begin(), facts_.end(), [](const auto& a, const auto& b) {
    return a.second.until < b.second.until;
  });
  if (oldest == facts_.end()) {
    timer_.cancel();
    return;
  }
  timer_.expires_at(oldest->second.until);
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error) forget_old();
  });
}

void ToldFacts::refuse(const std::string& why) {
  if (refusals_.size() == kMostRefusals || !refusals_.insert(why).second) return;
  events_.facts_refused(topic_, why);
}

record::Metadata ToldFacts::facts() const {
  record::Metadata facts;
  for (const auto& [key, fact] : facts_) facts.emplace(key, fact.value);
  return facts;
}

}  // namespace stickslip::fleet
