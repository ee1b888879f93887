/// \file
/// Replies to requests with an Idempotency-Key. A repeated request gets the stored reply, and nothing is done
/// twice.
///
/// Refusals are not stored: nothing was done, and the next attempt may succeed. Keys are stored per client,
/// so that one client cannot displace those of another. A client is a pair of name (Stickslip-Controller) and
/// identity (HttpRequest::peer).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <string>

#include "daemon/types/http.hpp"

namespace stickslip::control {

/// Main thread.
class Repeats {
 public:
  /// Most keys of one client. The oldest are forgotten: repetitions come within minutes.
  static constexpr std::size_t kKept = 256;
  /// Most bytes of requests and replies stored for one client.
  static constexpr std::size_t kKeptSize = std::size_t{1} << 20U;
  /// Longest key, bytes.
  static constexpr std::size_t kLongestKey = 128;
  static constexpr std::size_t kMostClients = 32;
  /// After this time without a key, a client may be forgotten in favour of a new one.
  static constexpr std::chrono::minutes kRemembered{10};

  enum class Found { kNew, kAnswered, kWaiting, kOther, kTooManyClients };

  /// Looks up a request's key; a new key is stored as waiting for its reply. kAnswered: answer() has the
  /// reply. kWaiting: the first request is still being carried out. kOther: the key was used for another
  /// request. kTooManyClients: nothing is stored.
  [[nodiscard]] Found look(const daemon::HttpRequest& request, std::int64_t now_ns) {
    Client* const client = client_of(request, now_ns);
    if (client == nullptr) return Found::kTooManyClients;
    client->used_ns = now_ns;
    const std::string asked = request.method + ' ' + request.target + '\n' + request.body;
    const auto entry = find(client->entries, request.idempotency_key);
    if (entry == client->entries.end()) {
      client->entries.push_back({request.idempotency_key, asked, std::nullopt});
      shorten(client->entries);
      return Found::kNew;
    }
    if (entry->asked != asked) return Found::kOther;
    return entry->reply ? Found::kAnswered : Found::kWaiting;
  }

  /// Stores the reply to a request that look() found new; forgets the key if the reply is a refusal.
  void answered(const daemon::HttpRequest& request, const daemon::HttpReply& reply) {
    const auto client = known(request);
    if (client == clients_.end()) return;
    const auto entry = find(client->entries, request.idempotency_key);
    if (entry == client->entries.end()) return;
    if (reply.status >= 200 && reply.status < 300) {
      entry->reply = reply;
      shorten(client->entries);
    } else {
      client->entries.erase(entry);
    }
  }

  /// The stored reply. Call it only after look() returned kAnswered.
  [[nodiscard]] daemon::HttpReply answer(const daemon::HttpRequest& request) {
    daemon::HttpReply reply = find(known(request)->entries, request.idempotency_key)->reply.value();
    reply.replayed = true;
    return reply;
  }

 private:
  struct Entry {
    std::string key;
    std::string asked;
    std::optional<daemon::HttpReply> reply;  ///< Absent: the request is being carried out.
    [[nodiscard]] std::size_t size() const {
      return key.size() + asked.size() + (reply ? reply->body.size() : 0);
    }
  };
  using Entries = std::deque<Entry>;
  struct Client {
    std::string name;
    std::int64_t used_ns = 0;
    Entries entries;  ///< The oldest first.
  };

  [[nodiscard]] static Entries::iterator find(Entries& entries, const std::string& key) {
    return std::find_if(entries.begin(), entries.end(), [&key](const Entry& one) { return one.key == key; });
  }

  [[nodiscard]] static std::string name_of(const daemon::HttpRequest& request) {
    return request.peer + '\n' + request.controller;
  }

  [[nodiscard]] std::list<Client>::iterator known(const daemon::HttpRequest& request) {
    return std::find_if(clients_.begin(), clients_.end(),
                        [name = name_of(request)](const Client& one) { return one.name == name; });
  }

  /// The client of a request, made if it is new. \return null if kMostClients are active.
  [[nodiscard]] Client* client_of(const daemon::HttpRequest& request, std::int64_t now_ns) {
    if (const auto found = known(request); found != clients_.end()) return &*found;
    if (clients_.size() == kMostClients) {
      const auto idle =
          std::min_element(clients_.begin(), clients_.end(),
                           [](const Client& a, const Client& b) { return a.used_ns < b.used_ns; });
      if (now_ns - idle->used_ns < std::chrono::nanoseconds{kRemembered}.count()) return nullptr;
      clients_.erase(idle);
    }
    return &clients_.emplace_back(Client{name_of(request), now_ns, {}});
  }

  /// Removes the oldest entries with a reply until the limits hold. The newest entry stays, however long.
  static void shorten(Entries& entries) {
    std::size_t size = 0;
    for (const Entry& entry : entries) size += entry.size();
    while (entries.size() > 1 && (entries.size() > kKept || size > kKeptSize)) {
      const auto oldest = std::find_if(entries.begin(), entries.end() - 1,
                                       [](const Entry& one) { return one.reply.has_value(); });
      if (oldest == entries.end() - 1) return;
      size -= oldest->size();
      entries.erase(oldest);
    }
  }

  std::list<Client> clients_;
};

}  // namespace stickslip::control
