/// \file
/// Requests with an Idempotency-Key: a repeated one gets the answer of then, and nothing is done twice.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// Main thread.
class Repeats {
 public:
  /// Older ones are forgotten: a client that repeats does so within minutes.
  static constexpr std::size_t kKept = 256;
  static constexpr std::size_t kLongestKey = 128;

  enum class Found { kNew, kAnswered, kWaiting, kOther };

  /// A new key is noted as waiting for its answer. kOther: the key was used for another request.
  [[nodiscard]] Found look(const HttpRequest& request) {
    const std::string asked =
        request.method + ' ' + request.target + '\n' + request.controller + '\n' + request.body;
    if (const Entry* entry = find(request.idempotency_key)) {
      if (entry->asked != asked) return Found::kOther;
      return entry->reply ? Found::kAnswered : Found::kWaiting;
    }
    entries_.push_back({request.idempotency_key, asked, {}});
    if (entries_.size() > kKept) entries_.pop_front();
    return Found::kNew;
  }
  void answered(const std::string& key, const HttpReply& reply) {
    for (Entry& entry : entries_) {
      if (entry.key == key) entry.reply = reply;
    }
  }
  /// Only after kAnswered.
  [[nodiscard]] HttpReply answer(const std::string& key) const {
    const Entry* entry = find(key);
    HttpReply reply = entry != nullptr && entry->reply ? *entry->reply : HttpReply{};
    reply.replayed = true;
    return reply;
  }

 private:
  struct Entry {
    std::string key;
    std::string asked;
    std::optional<HttpReply> reply;
  };
  [[nodiscard]] const Entry* find(const std::string& key) const {
    for (const Entry& entry : entries_) {
      if (entry.key == key) return &entry;
    }
    return nullptr;
  }
  std::deque<Entry> entries_;
};

}  // namespace stickslip::daemon
