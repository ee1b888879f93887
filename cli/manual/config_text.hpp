/// \file
/// The text of config/stickslipd.toml, built into the program: each key with unit, range and default.
#pragma once

#include <string_view>

namespace stickslip::manual {

[[nodiscard]] std::string_view stickslipd_toml() noexcept;

}  // namespace stickslip::manual
