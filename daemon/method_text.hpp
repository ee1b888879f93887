/// \file
/// The traditional rule as one line in a record, so that the record alone is enough to repeat it.
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/friction/method.hpp"

namespace stickslip::daemon {

/// "penner-1995 kinetic_cycles=10"
[[nodiscard]] std::string method_text(const friction::Method& method);

/// Reads what method_text() wrote; an empty text is the default method. Error: kUsage.
[[nodiscard]] base::Result<friction::Method> method_from_text(std::string_view text);

}  // namespace stickslip::daemon
