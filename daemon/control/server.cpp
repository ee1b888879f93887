#include "daemon/control/server.hpp"

#include <sys/stat.h>
#include <sys/un.h>

#include <optional>
#include <system_error>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <nlohmann/json.hpp>

namespace stickslip::daemon {
namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Local = asio::local::stream_protocol;

namespace {

constexpr mode_t kOwnerAndGroup = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;

HttpReply refusal(int status, const std::string& why) {
  return {status, nlohmann::json{{"error", why}}.dump(), {}};
}

/// One connection: request, reply, and again while the client keeps it.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Local::socket socket, std::shared_ptr<const HttpHandler> handler, HttpLimits limits,
             std::shared_ptr<int> connections)
      : stream_(std::move(socket)),
        handler_(std::move(handler)),
        limits_(limits),
        connections_(std::move(connections)) {
    ++*connections_;
  }
  ~Connection() { --*connections_; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(limits_.header_size);
    parser_->body_limit(limits_.body_size);
    stream_.expires_after(limits_.time);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code error, std::size_t) { self->was_read(error); });
  }

 private:
  void was_read(beast::error_code error) {
    if (!error) {
      const auto& request = parser_->get();
      reply(
          (*handler_)({std::string{request.method_string()}, std::string{request.target()}, request.body()}),
          request.version(), request.keep_alive());
    } else if (error == http::error::header_limit) {
      reply(refusal(431, fmt::format("the header is longer than {} bytes", limits_.header_size)), 11, false);
    } else if (error == http::error::body_limit) {
      reply(refusal(413, fmt::format("the body is longer than {} bytes", limits_.body_size)), 11, false);
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      reply(refusal(400, fmt::format("this is no HTTP request: {}", error.message())), 11, false);
    }
    // Else the client went away or was too slow: the stream closes with the last reference.
  }

  void reply(const HttpReply& reply, unsigned version, bool keep_alive) {
    response_ = {};
    response_.result(static_cast<unsigned>(reply.status));
    response_.version(version);
    response_.keep_alive(keep_alive);
    response_.set(http::field::content_type, "application/json");
    if (!reply.allow.empty()) response_.set(http::field::allow, reply.allow);
    response_.body() = reply.body;
    response_.prepare_payload();
    stream_.expires_after(limits_.time);
    http::async_write(stream_, response_,
                      [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t) {
                        if (!error && keep_alive) self->read();
                      });
  }

  beast::basic_stream<Local> stream_;
  std::shared_ptr<const HttpHandler> handler_;
  HttpLimits limits_;
  std::shared_ptr<int> connections_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
};

/// Removes what a daemon that was killed has left behind.
base::Result<void> remove_leftover(asio::io_context& io, const std::filesystem::path& path) {
  struct stat facts {};
  if (::lstat(path.c_str(), &facts) != 0) return {};
  if (!S_ISSOCK(facts.st_mode)) {
    return base::usage_error(
        "control socket {}: a file of another kind is there; remove it or choose another path",
        path.string());
  }
  Local::socket probe{io};
  boost::system::error_code error;
  probe.connect(Local::endpoint{path.string()}, error);
  if (!error) return base::failure("control socket {}: another process is listening there", path.string());
  ::unlink(path.c_str());
  return {};
}

}  // namespace

class ControlServer::Impl : public std::enable_shared_from_this<Impl> {
 public:
  Impl(asio::io_context& io, std::filesystem::path path, HttpHandler handler, HttpLimits limits)
      : acceptor_(io),
        path_(std::move(path)),
        handler_(std::make_shared<const HttpHandler>(std::move(handler))),
        limits_(limits) {}

  boost::system::error_code open() {
    boost::system::error_code error;
    const Local::endpoint endpoint{path_.string()};
    acceptor_.open(endpoint.protocol(), error);
    if (error) return error;
    // Between bind and chmod nobody but the owner may come in.
    const mode_t before = ::umask(~static_cast<mode_t>(S_IRUSR | S_IWUSR) & 0777U);
    acceptor_.bind(endpoint, error);
    ::umask(before);
    if (error) return error;
    bound_ = true;
    if (::chmod(path_.c_str(), kOwnerAndGroup) != 0) return {errno, boost::system::system_category()};
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    return error;
  }

  void accept() {
    acceptor_.async_accept(
        [self = shared_from_this()](boost::system::error_code error, Local::socket socket) {
          if (error == asio::error::operation_aborted) return;
          if (!error && *self->connections_ < self->limits_.connections) {
            std::make_shared<Connection>(std::move(socket), self->handler_, self->limits_, self->connections_)
                ->read();
          }
          self->accept();
        });
  }

  void close() {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    if (bound_) ::unlink(path_.c_str());
    bound_ = false;
  }

 private:
  Local::acceptor acceptor_;
  std::filesystem::path path_;
  std::shared_ptr<const HttpHandler> handler_;
  HttpLimits limits_;
  std::shared_ptr<int> connections_ = std::make_shared<int>(0);
  bool bound_ = false;
};

ControlServer::ControlServer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

ControlServer::~ControlServer() { impl_->close(); }

base::Result<std::unique_ptr<ControlServer>> ControlServer::listen(asio::io_context& io,
                                                                   const std::filesystem::path& socket,
                                                                   HttpHandler handler, HttpLimits limits) {
  constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;
  if (socket.native().size() > kLongestPath) {
    return base::usage_error("control socket {}: the path is longer than {} bytes, the limit of the system",
                             socket.string(), kLongestPath);
  }
  if (base::Result<void> removed = remove_leftover(io, socket); !removed) {
    return tl::unexpected(removed.error());
  }
  auto impl = std::make_shared<Impl>(io, socket, std::move(handler), limits);
  if (const boost::system::error_code error = impl->open()) {
    impl->close();
    return base::failure("control socket {}: {}", socket.string(), error.message());
  }
  impl->accept();
  return std::unique_ptr<ControlServer>(new ControlServer(std::move(impl)));
}

}  // namespace stickslip::daemon
