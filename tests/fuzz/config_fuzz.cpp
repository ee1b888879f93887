// Any text is a configuration or is refused in one line.

#include <string_view>

#include "core/base/contract.hpp"
#include "daemon/config.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  const auto settings = base::Settings::parse({reinterpret_cast<const char*>(data), size}, "x.toml");
  const auto config = settings ? daemon::read_config(*settings, "/nowhere")
                               : base::Result<daemon::DaemonConfig>{tl::unexpected(settings.error())};
  STICKSLIP_EXPECTS(config || config.error().exit_status() == 2);
  STICKSLIP_EXPECTS(config || config.error().message.find('\n') == std::string::npos);
  return 0;
}
