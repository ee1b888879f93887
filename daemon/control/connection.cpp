#include "daemon/control/connection.hpp"

#include <memory>
#include <optional>

#include <boost/asio/dispatch.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "daemon/control/live_connection.hpp"
#include "daemon/control/reply.hpp"

namespace stickslip::daemon {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::string_view kLivePath = "/v1/live";

/// Nothing comes from elsewhere, nothing is written into the page, nobody frames it.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri "
    "'none'; "
    "form-action 'none'; frame-ancestors 'none'";

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(AnySocket socket, std::shared_ptr<Service> service)
      : stream_(std::move(socket)), service_(std::move(service)) {
    ++service_->connection_count;
  }
  ~Connection() { --service_->connection_count; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(service_->limits.header_size);
    parser_->body_limit(service_->limits.body_size);
    stream_.expires_after(service_->limits.time);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code error, std::size_t) { self->was_read(error); });
  }

 private:
  void was_read(beast::error_code error) {
    if (!error) {
      answer_request();
    } else if (error == http::error::header_limit) {
      reply(refusal(431, fmt::format("the header is longer than {} bytes", service_->limits.header_size)), 11,
            false);
    } else if (error == http::error::body_limit) {
      reply(refusal(413, fmt::format("the body is longer than {} bytes", service_->limits.body_size)), 11,
            false);
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      reply(refusal(400, fmt::format("this is no HTTP request: {}", error.message())), 11, false);
    }
    // Else the client went away or was too slow: the stream closes with the last reference.
  }

  void answer_request() {
    const auto& request = parser_->get();
    const unsigned version = request.version();
    const bool keep = request.keep_alive();
    const std::string_view target = view(request.target());
    const std::string_view path = target.substr(0, target.find('?'));
    const auto header = [&request](http::field field) { return view(request[field]); };
    const Knock knock{path, header(http::field::host), header(http::field::origin),
                      header(http::field::authorization), header(http::field::sec_websocket_protocol)};
    if (auto refused = refuse_at(service_->door, knock)) {
      reply(*refused, version, false);
      return;
    }
    if (path == kLivePath && service_->hub != nullptr) {
      if (!beast::websocket::is_upgrade(request)) {
        reply(refusal(426, "the live stream is a WebSocket: ask for an upgrade"), version, keep);
        return;
      }
      stream_.expires_never();
      serve_live(stream_.release_socket(), parser_->release(), service_);
      return;
    }
    const HttpRequest asked{std::string{view(request.method_string())}, std::string{target}, request.body(),
                            std::string{view(request["Stickslip-Controller"])},
                            std::string{view(request["Idempotency-Key"])}};
    service_->handler(asked, [self = shared_from_this(), version, keep](const HttpReply& answer) {
      self->reply(answer, version, keep);
    });
  }

  void reply(const HttpReply& reply, unsigned version, bool keep_alive) {
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
    if (reply.replayed) response_.set("Idempotency-Replayed", "true");
    response_.body() = reply.body;
    response_.prepare_payload();
    stream_.expires_after(service_->limits.time);
    http::async_write(stream_, response_,
                      [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t) {
                        if (!error && keep_alive) self->read();
                      });
  }

  beast::basic_stream<boost::asio::generic::stream_protocol> stream_;
  std::shared_ptr<Service> service_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

void serve_connection(AnySocket socket, std::shared_ptr<Service> service) {
  // Who answers may be the last to let go, on any thread; a socket belongs to its own.
  const auto executor = socket.get_executor();
  const auto end_there = [executor](Connection* connection) {
    boost::asio::dispatch(executor, [owned = std::unique_ptr<Connection>{connection}] {});
  };
  std::shared_ptr<Connection> { new Connection{std::move(socket), std::move(service)}, end_there } -> read();
}

}  // namespace stickslip::daemon
