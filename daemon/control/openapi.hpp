/// \file
/// The description of the control interface (openapi.json), built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::daemon {

[[nodiscard]] std::string_view openapi() noexcept;

}  // namespace stickslip::daemon
