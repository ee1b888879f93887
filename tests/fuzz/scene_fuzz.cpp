// Any text is a scene or is refused in one line.

#include <string_view>

#include "core/base/contract.hpp"
#include "core/sim/scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  const auto scene = sim::parse_scene({reinterpret_cast<const char*>(data), size}, "/nowhere/x.toml");
  STICKSLIP_EXPECTS(scene || scene.error().exit_status() == 2);
  STICKSLIP_EXPECTS(scene || scene.error().message.find('\n') == std::string::npos);
  return 0;
}
