#include "daemon/client/live_client.hpp"

#include <chrono>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/client.hpp"

namespace stickslip::client {

base::Result<void> listen_live(const std::filesystem::path& socket,
                               const std::function<bool(std::string_view frame)>& use) {
  namespace asio = boost::asio;
  namespace beast = boost::beast;
  using LocalProtocol = asio::local::stream_protocol;
  asio::io_context io;
  beast::websocket::stream<LocalProtocol::socket> stream{io};
  boost::system::error_code error;
  stream.next_layer().connect(LocalProtocol::endpoint{socket.string()}, error);
  if (error) {
    return base::failure("{}: nobody answers: {}; is stickslipd running with this control socket?",
                         socket.string(), error.message());
  }
  stream.handshake("localhost", "/v1/live", error);
  if (error) {
    std::string why = error.message();
    // Beast keeps to itself what the daemon said; asked again, it says the same.
    constexpr std::chrono::seconds kLongest{10};
    const auto said = request(socket, {"GET", "/v1/live", "", "", ""}, kLongest);
    if (said && said->status == 503) why = nlohmann::json::parse(said->body).value("error", why);
    return base::failure("{}: no live stream: {}", socket.string(), why);
  }
  beast::flat_buffer buffer;
  for (;;) {
    buffer.clear();
    stream.read(buffer, error);
    // A daemon that ends does so without farewell.
    if (error == beast::websocket::error::closed || error == asio::error::eof) return {};
    if (error) return base::failure("{}: the stream broke off: {}", socket.string(), error.message());
    const auto data = buffer.data();
    if (!use({static_cast<const char*>(data.data()), data.size()})) return {};
  }
}

}  // namespace stickslip::client
