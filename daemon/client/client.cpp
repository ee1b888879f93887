#include "daemon/client/client.hpp"

#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace stickslip::client {
namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Local = asio::local::stream_protocol;

base::Result<daemon::HttpReply> request(const std::filesystem::path& socket,
                                        const daemon::HttpRequest& request,
                                        std::chrono::milliseconds timeout) {
  asio::io_context io;
  beast::basic_stream<Local> stream{io};
  boost::system::error_code error;
  stream.socket().connect(Local::endpoint{socket.string()}, error);
  if (error) {
    return base::failure("{}: nobody answers: {}; is stickslipd running with this control socket?",
                         socket.string(), error.message());
  }
  http::request<http::string_body> message{http::string_to_verb(request.method), request.target, 11};
  message.method_string(request.method);
  message.set(http::field::host, "localhost");
  message.keep_alive(false);
  if (!request.controller.empty()) message.set("Stickslip-Controller", request.controller);
  if (!request.idempotency_key.empty()) message.set("Idempotency-Key", request.idempotency_key);
  message.body() = request.body;
  message.prepare_payload();

  beast::flat_buffer buffer;
  http::response<http::string_body> response;
  stream.expires_after(timeout);
  http::async_write(stream, message, [&](beast::error_code write_error, std::size_t) {
    // A refusal may arrive before the whole request has left: read in any case.
    http::async_read(stream, buffer, response, [&, write_error](beast::error_code read_error, std::size_t) {
      error = write_error && read_error ? write_error : read_error;
    });
  });
  io.run();
  if (error) return base::failure("{}: no whole answer: {}", socket.string(), error.message());
  return daemon::HttpReply{static_cast<int>(response.result_int()),
                           response.body(),
                           std::string{response[http::field::allow]},
                           std::string{response[http::field::content_type]},
                           response.find("Idempotency-Replayed") != response.end(),
                           {},
                           std::string{response["Stickslip-Warning"]}};
}

}  // namespace stickslip::client
