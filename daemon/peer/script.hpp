/// \file
/// daemon/peer/scipy_chain.py, built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::daemon::peer {

[[nodiscard]] std::string_view scipy_chain_py() noexcept;

}  // namespace stickslip::daemon::peer
