/// \file
/// Values of options.
#pragma once

#include <optional>
#include <string>

#include "core/base/quantity.hpp"
#include "core/base/result.hpp"

namespace stickslip::cli {

/// Reads the quantity of an option, in SI units; nothing if the option was not given. A number without a unit
/// is read in SI units with a warning on stderr, unless `bare` says otherwise. Errors: kUsage, naming the
/// option.
[[nodiscard]] base::Result<std::optional<double>> number_of(
    const char* option, const std::string& text, base::Dimension dimension, bool must_be_positive,
    base::BareNumber bare = base::BareNumber::kSiWithWarning);

}  // namespace stickslip::cli
