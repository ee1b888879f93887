// A client of the live stream that sends anything: the stream goes on or ends, and others get their frames.

#include "tests/fuzz/raw_client.hpp"

namespace {

constexpr std::string_view kUpgrade =
    "GET /v1/live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  fuzz::RawClient client{control::AccessPolicy{}};
  STICKSLIP_EXPECTS(client.send(bytes_of(kUpgrade)).starts_with("HTTP/1.1 101"));
  STICKSLIP_EXPECTS(client.hub().client_count() == 1);
  // In two parts, with a frame between them: a client is read and written to at once.
  const std::size_t half = size / 2;
  static_cast<void>(client.send({data, half}));
  client.hub().publish(std::make_shared<const std::string>("{\"type\":\"bench\"}"));
  static_cast<void>(client.send({data + half, size - half}));
  client.say_no_more();
  static_cast<void>(client.send({}));
  return 0;
}
