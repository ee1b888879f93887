#include "daemon/control/connection.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "daemon/control/live_connection.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::string_view kLivePath = "/v1/live";

/// Content-Security-Policy of the daemon's pages: no foreign sources, no inline scripts or styles, no
/// framing.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri "
    "'none'; "
    "form-action 'none'; frame-ancestors 'none'";

constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// Headers that a request may hold only once; two of them would be ambiguous.
std::optional<std::string> repeated_header(const http::fields& header) {
  for (const char* name :
       {"Host", "Origin", "Authorization", "Expect", "Stickslip-Controller", "Idempotency-Key"}) {
    if (header.count(name) > 1) return name;
  }
  return std::nullopt;
}

/// Identity of the client: "uid 1000" on a Unix socket, "token" over TCP.
std::string peer_of(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  const bool known = ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  return known && peer.uid != static_cast<uid_t>(-1) ? fmt::format("uid {}", peer.uid) : "token";
}

class Connection : public Newcomer, public std::enable_shared_from_this<Connection> {
 public:
  Connection(AnySocket socket, std::shared_ptr<Service> service)
      : stream_(std::move(socket)),
        service_(std::move(service)),
        place_(service_->newcomers.insert(service_->newcomers.end(), this)) {
    if (service_->newcomers.size() > service_->limits.newcomers) service_->newcomers.front()->turn_away();
  }
  ~Connection() override {
    leave_newcomers();
    if (let_in_) --service_->connection_count;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(service_->limits.header_size);
    parser_->body_limit(service_->limits.body_size);
    auto& newcomers = service_->newcomers;
    if (place_) newcomers.splice(newcomers.end(), newcomers, *place_);
    stream_.expires_after(time());
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code error, std::size_t) { self->header_was_read(error); });
  }

  void turn_away() override {
    leave_newcomers();
    stream_.close();
  }

 private:
  [[nodiscard]] std::chrono::milliseconds time() const {
    const HttpLimits& limits = service_->limits;
    return let_in_ ? limits.time : std::min(limits.time, limits.newcomer_time);
  }

  void leave_newcomers() {
    if (place_) service_->newcomers.erase(*place_);
    place_.reset();
  }

  /// Admits the client. \return false if `connections` clients are admitted already.
  [[nodiscard]] bool let_in() {
    if (let_in_) return true;
    if (service_->connection_count >= service_->limits.connections) return false;
    leave_newcomers();
    ++service_->connection_count;
    let_in_ = true;
    return true;
  }

  void header_was_read(beast::error_code error) {
    bodyless_ = !error && parser_->get().method() == http::verb::head;
    if (error || parser_->is_done()) return was_read(error);
    const std::string_view expected = view(parser_->get()[http::field::expect]);
    if (expected.empty() || parser_->get().version() < 11) return read_body();
    if (!beast::iequals(parser_->get()[http::field::expect], "100-continue")) {
      return refuse(417, "Expect: only 100-continue is known");
    }
    // A refused client need not send the body.
    if (const auto refused = refusal_of_header()) return reply(*refused, parser_->get().version(), false);
    boost::asio::async_write(stream_, boost::asio::buffer(kContinue),
                             [self = shared_from_this()](beast::error_code failed, std::size_t) {
                               if (!failed) self->read_body();
                             });
  }

  void read_body() {
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code error, std::size_t) { self->was_read(error); });
  }

  void was_read(beast::error_code error) {
    if (!error) {
      answer_request();
    } else if (error == http::error::header_limit) {
      refuse(431, fmt::format("the header is longer than {} bytes", service_->limits.header_size));
    } else if (error == http::error::body_limit) {
      refuse(413, fmt::format("the body is longer than {} bytes", service_->limits.body_size));
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      refuse(400, fmt::format("this is no HTTP request: {}", error.message()));
    }
    // Else the client went away or was too slow: the stream closes with the last reference.
  }

  /// Sends a refusal and closes the connection, because the end of the faulty request is unknown.
  void refuse(int status, const std::string& why) { reply(daemon::refusal(status, why), 11, false); }

  [[nodiscard]] std::string_view header(http::field field) const { return view(parser_->get()[field]); }
  [[nodiscard]] std::string_view path() const {
    const std::string_view target = view(parser_->get().target());
    return target.substr(0, target.find('?'));
  }

  [[nodiscard]] std::optional<daemon::HttpReply> refusal_of_header() const {
    if (const auto twice = repeated_header(parser_->get()))
      return daemon::refusal(400, fmt::format("{}: stands there twice; send it once", *twice));
    return access_refusal(service_->policy,
                          {path(), header(http::field::host), header(http::field::origin),
                           header(http::field::authorization), header(http::field::sec_websocket_protocol)});
  }

  void answer_request() {
    const auto& request = parser_->get();
    const unsigned version = request.version();
    const bool keep = request.keep_alive();
    if (const auto refused = refusal_of_header()) {
      reply(*refused, version, false);
      return;
    }
    // Requests for the page need no token, so they do not admit a client.
    if ((service_->policy.open || !is_page(path())) && !let_in()) {
      reply(daemon::refusal(
                503, fmt::format("{} connections are open, and there is room for no more: close one, or "
                                 "try again later",
                                 service_->connection_count)),
            version, false);
      return;
    }
    if (path() == kLivePath && service_->hub != nullptr) {
      if (!service_->hub->has_room()) {
        reply(daemon::refusal(503, std::string{kLiveIsFull}), version, false);
        return;
      }
      if (!beast::websocket::is_upgrade(request)) {
        reply(daemon::refusal(426, "the live stream is a WebSocket: ask for an upgrade"), version, keep);
        return;
      }
      stream_.expires_never();
      serve_live(stream_.release_socket(), parser_->release(), service_);
      return;
    }
    const daemon::HttpRequest asked{bodyless_ ? "GET" : std::string{view(request.method_string())},
                                    std::string{view(request.target())},
                                    request.body(),
                                    std::string{view(request["Stickslip-Controller"])},
                                    std::string{view(request["Idempotency-Key"])},
                                    peer_of(stream_.socket().native_handle())};
    service_->handler(asked, [self = shared_from_this(), version, keep](const daemon::HttpReply& answer) {
      self->reply(answer, version, keep);
    });
  }

  void reply(const daemon::HttpReply& reply, unsigned version, bool keep_alive) {
    response_ = {};
    response_.result(static_cast<unsigned>(reply.status));
    response_.version(version);
    response_.keep_alive(keep_alive);
    response_.set(http::field::content_type, reply.content_type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy",
                  reply.content_policy.empty() ? std::string{kContentPolicy} : reply.content_policy);
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    if (!reply.allow.empty()) response_.set(http::field::allow, reply.allow);
    if (reply.status == 401) response_.set(http::field::www_authenticate, "Bearer");
    if (!reply.warning.empty()) response_.set("Stickslip-Warning", reply.warning);
    if (reply.replayed) response_.set("Idempotency-Replayed", "true");
    response_.body() = reply.body;
    response_.prepare_payload();
    stream_.expires_after(time());
    const auto written = [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t) {
      if (!error && keep_alive) self->read();
    };
    // To HEAD as to GET, the length too, but for the body [RFC 9110, 9.3.2].
    serializer_.emplace(response_);
    if (std::exchange(bodyless_, false)) {
      http::async_write_header(stream_, *serializer_, written);
    } else {
      http::async_write(stream_, *serializer_, written);
    }
  }

  beast::basic_stream<boost::asio::generic::stream_protocol> stream_;
  std::shared_ptr<Service> service_;
  /// Position among the newcomers, until the client is admitted.
  std::optional<std::list<Newcomer*>::iterator> place_;
  bool let_in_ = false;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool bodyless_ = false;  ///< The request is HEAD: the reply has no body.
};

}  // namespace

void serve_connection(AnySocket socket, std::shared_ptr<Service> service) {
  // The last owner may release the connection on any thread, so its destructor is dispatched to the socket's
  // executor.
  const auto executor = socket.get_executor();
  const auto end_there = [executor](Connection* connection) {
    boost::asio::dispatch(executor, [owned = std::unique_ptr<Connection>{connection}] {});
  };
  std::shared_ptr<Connection> { new Connection{std::move(socket), std::move(service)}, end_there } -> read();
}

}  // namespace stickslip::control
