/// \file
/// Requests with an Idempotency-Key: one that is repeated gets the answer of then, and nothing is done twice.
///
/// What was refused is not kept: nothing was done, and the next try may be granted. Each client has keys of
/// its own, so that nobody else's can push them out. A client is a name (Stickslip-Controller) of somebody
/// whom the system let in (HttpRequest::peer).
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
  /// Of one client. Its older ones are forgotten: a client that repeats does so within minutes.
  static constexpr std::size_t kKept = 256;
  /// The same, in bytes of its requests and answers.
  static constexpr std::size_t kKeptSize = std::size_t{1} << 20U;
  static constexpr std::size_t kLongestKey = 128;
  static constexpr std::size_t kMostClients = 32;
  /// A client that has used no key for so long makes room for another, and none before.
  static constexpr std::chrono::minutes kRemembered{10};

  enum class Found { kNew, kAnswered, kWaiting, kOther, kTooManyClients };

  /// A new key is noted as waiting for its answer. kOther: the key was used for another request.
  /// kTooManyClients: nothing is noted.
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

  /// Only after kAnswered.
  [[nodiscard]] daemon::HttpReply answer(const daemon::HttpRequest& request) {
    daemon::HttpReply reply = find(known(request)->entries, request.idempotency_key)->reply.value();
    reply.replayed = true;
    return reply;
  }

 private:
  struct Entry {
    std::string key;
    std::string asked;
    std::optional<daemon::HttpReply> reply;  ///< None: it waits.
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

  /// \return null if there is no room for it.
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

  /// The oldest that are answered go; the newest stays, however long.
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
