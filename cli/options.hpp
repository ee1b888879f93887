/// \file
/// Values of options.
#pragma once

#include <optional>
#include <string>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::cli {

/// The option's number in SI units, typed with a unit or without; nothing if it was not given.
/// Usage error that names the option.
[[nodiscard]] base::Result<std::optional<double>> number_of(const char* option, const std::string& text,
                                                            base::Dimension dimension, bool must_be_positive);

}  // namespace stickslip::cli
