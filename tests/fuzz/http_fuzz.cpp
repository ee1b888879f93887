// Whatever comes over a connection, the server answers in HTTP or says nothing. The first bit chooses between
// the Unix socket and a TCP port.

#include "tests/fuzz/raw_client.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  if (size == 0) return 0;
  fuzz::RawClient client{(data[0] & 1) != 0 ? fuzz::tcp_policy() : control::AccessPolicy{}};
  const std::string answer = client.send({data + 1, size - 1});
  client.say_no_more();
  const std::string rest = client.send({});
  STICKSLIP_EXPECTS(answer.empty() || answer.starts_with("HTTP/1."));
  // Behind a TCP port nothing but the page is shown to who has no token, and no token is in the dictionary.
  const bool closed = (data[0] & 1) != 0;
  STICKSLIP_EXPECTS(!closed || (answer + rest).find("\"scan_count\"") == std::string::npos);
  return 0;
}
