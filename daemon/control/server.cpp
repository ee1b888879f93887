#include "daemon/control/server.hpp"

#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <optional>
#include <system_error>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/base/contract.hpp"
#include "daemon/control/connection.hpp"
#include "daemon/control/inherited_socket.hpp"

namespace stickslip::control {
namespace asio = boost::asio;
using Local = asio::local::stream_protocol;
using asio::ip::tcp;

namespace {

constexpr mode_t kOwnerAndGroup = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;

using FileIdentity = std::pair<dev_t, ino_t>;

/// The identity of a file, or nothing if it is absent. Links are not followed.
std::optional<FileIdentity> file_at(const std::filesystem::path& path) {
  struct stat facts {};
  if (::lstat(path.c_str(), &facts) != 0) return std::nullopt;
  return FileIdentity{facts.st_dev, facts.st_ino};
}

/// Accepts connections until close().
template <typename Protocol>
class AcceptorOf : public ControlServer::Listener, public std::enable_shared_from_this<AcceptorOf<Protocol>> {
 public:
  AcceptorOf(asio::io_context& io, std::shared_ptr<Service> service)
      : acceptor_(io), service_(std::move(service)), again_(io) {}

  void accept() {
    acceptor_.async_accept(
        [self = this->shared_from_this()](boost::system::error_code error, typename Protocol::socket socket) {
          if (error == asio::error::operation_aborted) return;
          // The waiting client stays in the queue, so an immediate retry would fail again.
          if (error) return self->accept_later();
          serve_connection(AnySocket{std::move(socket)}, self->service_);
          self->accept();
        });
  }

  void close() override {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    again_.cancel();
  }

 private:
  void accept_later() {
    again_.expires_after(service_->limits.accept_again);
    again_.async_wait([self = this->shared_from_this()](boost::system::error_code error) {
      if (!error && self->acceptor_.is_open()) self->accept();
    });
  }

 protected:
  typename Protocol::acceptor acceptor_;
  std::shared_ptr<Service> service_;

 private:
  asio::steady_timer again_;
};

class LocalAcceptor final : public AcceptorOf<Local> {
 public:
  LocalAcceptor(asio::io_context& io, std::filesystem::path path, std::shared_ptr<Service> service)
      : AcceptorOf(io, std::move(service)), path_(std::move(path)) {}

  /// \param socket  that listens already; this object owns it from now on.
  boost::system::error_code adopt(int socket) {
    boost::system::error_code error;
    acceptor_.assign(Local{}, socket, error);
    if (error) ::close(socket);
    return error;
  }

  boost::system::error_code open() {
    boost::system::error_code error;
    const Local::endpoint endpoint{path_.string()};
    acceptor_.open(endpoint.protocol(), error);
    if (error) return error;
    // Between bind and chmod only the owner may connect.
    const mode_t before = ::umask(~static_cast<mode_t>(S_IRUSR | S_IWUSR) & 0777U);
    acceptor_.bind(endpoint, error);
    ::umask(before);
    if (error) return error;
    bound_ = file_at(path_);
    if (::chmod(path_.c_str(), kOwnerAndGroup) != 0) return {errno, boost::system::system_category()};
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    return error;
  }

  void close() override {
    AcceptorOf::close();
    // Another daemon may have come to the same path since: its socket stays.
    if (bound_ && bound_ == file_at(path_)) ::unlink(path_.c_str());
    bound_.reset();
  }

 private:
  std::filesystem::path path_;
  std::optional<FileIdentity> bound_;  ///< The socket file that this object made.
};

class TcpAcceptor final : public AcceptorOf<tcp> {
 public:
  using AcceptorOf::AcceptorOf;

  boost::system::error_code open(const tcp::endpoint& endpoint) {
    boost::system::error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address{true}, error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    return error;
  }
  [[nodiscard]] unsigned short port() const {
    boost::system::error_code ignored;
    return acceptor_.local_endpoint(ignored).port();
  }
};

/// Removes the socket file that a killed daemon left behind.
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
  probe.open({}, error);
  // A full queue must not hold up the start.
  if (!error) probe.non_blocking(true, error);
  if (!error) probe.connect(Local::endpoint{path.string()}, error);
  if (!error) {
    return base::failure(
        "control socket {}: another process is listening there: stop it, or choose another path in "
        "[control] socket",
        path.string());
  }
  if (error == boost::system::errc::no_such_file_or_directory) return {};
  // Only connection_refused proves that no process listens. Any other error may come from a socket in use: of
  // another user, or with a full queue.
  if (error != asio::error::connection_refused) {
    return base::failure(
        "control socket {}: is there, and whether anybody listens cannot be asked: {}: remove it if it is "
        "left over, or choose another path in [control] socket",
        path.string(), error.message());
  }
  ::unlink(path.c_str());
  return {};
}

/// Resolves without look-up: only loopback addresses are accepted.
base::Result<tcp::endpoint> loopback(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon);
  unsigned short port = 0;
  const char* const end = address.data() + address.size();
  bool number = false;
  if (colon != std::string::npos && colon + 1 < address.size()) {
    const auto [stopped, bad] = std::from_chars(address.data() + colon + 1, end, port);
    number = bad == std::errc{} && stopped == end;
  }
  if (host == "localhost") host = "127.0.0.1";
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  boost::system::error_code error;
  const asio::ip::address ip = asio::ip::make_address(host, error);
  if (!number || error) {
    return base::usage_error(
        "[control] http = \"{}\": must be an address and a port, such as \"127.0.0.1:8037\"", address);
  }
  if (!ip.is_loopback()) {
    return base::usage_error(
        "[control] http = \"{}\": must be an address of this machine, such as \"127.0.0.1:8037\"; for others "
        "put a proxy with its own checks before it",
        address);
  }
  return tcp::endpoint{ip, port};
}

}  // namespace

ControlServer::ControlServer(std::shared_ptr<Listener> listener, std::string address)
    : listener_(std::move(listener)), address_(std::move(address)) {}

ControlServer::~ControlServer() { listener_->close(); }

base::Result<std::unique_ptr<ControlServer>> ControlServer::listen(asio::io_context& io,
                                                                   const std::filesystem::path& socket,
                                                                   daemon::HttpHandler handler,
                                                                   HttpLimits limits, daemon::LiveHub* hub) {
  constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;
  if (socket.native().size() > kLongestPath) {
    return base::usage_error("control socket {}: the path is longer than {} bytes, the limit of the system",
                             socket.string(), kLongestPath);
  }
  const std::optional<int> inherited = inherited_socket(socket);
  if (!inherited) {
    if (base::Result<void> removed = remove_leftover(io, socket); !removed)
      return tl::unexpected(removed.error());
  }
  auto service = std::make_shared<Service>(Service{{}, std::move(handler), hub, limits});
  auto listener = std::make_shared<LocalAcceptor>(io, socket, std::move(service));
  if (const boost::system::error_code error = inherited ? listener->adopt(*inherited) : listener->open()) {
    listener->close();
    return base::failure("control socket {}: {}", socket.string(), error.message());
  }
  listener->accept();
  return std::unique_ptr<ControlServer>(new ControlServer(std::move(listener), socket.string()));
}

base::Result<std::unique_ptr<ControlServer>> ControlServer::listen_tcp(
    asio::io_context& io, const std::string& address, const std::string& token, daemon::HttpHandler handler,
    HttpLimits limits, daemon::LiveHub* hub) {
  STICKSLIP_EXPECTS(!token.empty());
  const base::Result<tcp::endpoint> endpoint = loopback(address);
  if (!endpoint) return tl::unexpected(endpoint.error());
  auto service = std::make_shared<Service>(Service{{false, {}, token}, std::move(handler), hub, limits});
  auto listener = std::make_shared<TcpAcceptor>(io, service);
  if (const boost::system::error_code error = listener->open(*endpoint)) {
    return base::failure("[control] http = \"{}\": {}", address, error.message());
  }
  const unsigned short port = listener->port();
  for (const char* host : {"127.0.0.1", "localhost", "[::1]"})
    service->policy.hosts.push_back(fmt::format("{}:{}", host, port));
  listener->accept();
  const std::string host = address.substr(0, address.rfind(':'));
  return std::unique_ptr<ControlServer>(
      new ControlServer(std::move(listener), fmt::format("{}:{}", host, port)));
}

}  // namespace stickslip::control
