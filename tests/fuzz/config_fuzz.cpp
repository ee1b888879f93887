// Any text is a configuration or is refused in one line.

#include <string_view>

#include "io/config.hpp"

#include "core/base/contract.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  const auto settings = base::Settings::parse({reinterpret_cast<const char*>(data), size}, "x.toml");
  const auto config = settings ? io::read_config(*settings, "/nowhere")
                               : base::Result<io::DaemonConfig>{tl::unexpected(settings.error())};
  STICKSLIP_EXPECTS(config || config.error().exit_status() == 2);
  STICKSLIP_EXPECTS(config || config.error().message.find('\n') == std::string::npos);
  return 0;
}
