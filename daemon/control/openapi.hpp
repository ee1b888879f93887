/// \file
/// The description of the control interface: the text of openapi.json, which cmake/embed.cmake builds into
/// the program.
#pragma once

#include <string_view>

namespace stickslip::control {

[[nodiscard]] std::string_view openapi() noexcept;

}  // namespace stickslip::control
