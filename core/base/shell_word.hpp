/// \file
/// Quoting of arguments for a shell.
#pragma once

#include <string>
#include <string_view>

namespace stickslip::base {

/// The argument as a POSIX shell reads it back as one word, in single quotes if it is empty or has a
/// character that means something to a shell.
[[nodiscard]] std::string shell_word(std::string_view argument);

}  // namespace stickslip::base
