/// \file
/// Commands as text.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::base {

/// An argument as a shell would take it again.
[[nodiscard]] std::string shell_word(std::string_view argument);

}  // namespace stickslip::base
