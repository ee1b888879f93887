#include "daemon/control/live_connection.hpp"

#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

namespace stickslip::control {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

/// Longest message accepted from a client, bytes.
constexpr std::size_t kLongestMessage = 1024;
/// Asks for the kept frames first.
constexpr std::string_view kWithHistory = "?history=1";

class LiveConnection final : public daemon::LiveClient, public std::enable_shared_from_this<LiveConnection> {
 public:
  LiveConnection(AnySocket socket, http::request<http::string_body> request, std::shared_ptr<Service> service)
      : stream_(std::move(socket)), request_(std::move(request)), service_(std::move(service)) {
    ++service_->connection_count;
  }
  ~LiveConnection() override { --service_->connection_count; }
  LiveConnection(const LiveConnection&) = delete;
  LiveConnection& operator=(const LiveConnection&) = delete;

  void open() {
    stream_.set_option(
        websocket::stream_base::timeout{service_->limits.time, service_->limits.live_idle, true});
    stream_.set_option(websocket::stream_base::decorator([this](websocket::response_type& response) {
      // A browser that named subprotocols wants one of them back; the one with the token never is.
      const auto named = request_[http::field::sec_websocket_protocol];
      const std::string_view asked{named.data(), named.size()};
      if (asked.find(kLiveProtocol) != std::string_view::npos) {
        response.set(http::field::sec_websocket_protocol, std::string{kLiveProtocol});
      }
    }));
    stream_.read_message_max(kLongestMessage);
    stream_.async_accept(request_, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      if (!self->service_->hub->join(self.get())) return self->say_that_it_is_full();
      self->joined_ = self;
      self->stream_.text(true);
      const auto target = self->request_.target();
      if (std::string_view{target.data(), target.size()}.ends_with(kWithHistory))
        self->offer(self->service_->hub->history());
      self->read();
    });
  }

  std::size_t offer(const daemon::LiveFrame& frame) override {
    const std::size_t dropped = queue_.push(frame);
    if (!writing_) write();
    return dropped;
  }

  void close() override {
    beast::get_lowest_layer(stream_).close();
    leave();
  }

 private:
  /// Closes the stream: other clients took the last places during the handshake.
  void say_that_it_is_full() {
    const websocket::close_reason why{websocket::close_code::try_again_later,
                                      std::string{kLiveIsFull}.c_str()};
    stream_.async_close(why, [self = shared_from_this()](beast::error_code) {});
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) {
        self->leave();
        return;
      }
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

  void write() {
    writing_ = queue_.pop();
    stream_.async_write(boost::asio::buffer(*writing_),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          self->writing_.reset();
                          if (error) {
                            self->leave();
                          } else if (!self->queue_.empty()) {
                            self->write();
                          }
                        });
  }

  /// Leaves the hub. The object lives until its pending operations end.
  void leave() {
    service_->hub->leave(this);
    joined_.reset();
  }

  websocket::stream<beast::basic_stream<boost::asio::generic::stream_protocol>> stream_;
  http::request<http::string_body> request_;
  std::shared_ptr<Service> service_;
  std::shared_ptr<LiveConnection> joined_;  ///< Keeps this object alive while it is in the hub.
  beast::flat_buffer buffer_;
  daemon::LiveQueue queue_;
  daemon::LiveFrame writing_;
};

}  // namespace

void serve_live(AnySocket socket, http::request<http::string_body> request,
                std::shared_ptr<Service> service) {
  std::make_shared<LiveConnection>(std::move(socket), std::move(request), std::move(service))->open();
}

}  // namespace stickslip::control
