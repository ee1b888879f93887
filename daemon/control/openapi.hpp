/// \file
/// The description of the control interface (openapi.json), built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::control {

[[nodiscard]] std::string_view openapi() noexcept;

}  // namespace stickslip::control
