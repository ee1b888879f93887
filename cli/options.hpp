/// \file
/// Values of options.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::cli {

/// The option's number in SI units, typed with a unit or without; nothing if it was not given.
/// Usage error that names the option.
[[nodiscard]] base::Result<std::optional<double>> number_of(const char* option, const std::string& text,
                                                            base::Dimension dimension, bool must_be_positive);

/// An argument as a shell would take it again.
[[nodiscard]] std::string shell_word(std::string_view argument);

}  // namespace stickslip::cli
