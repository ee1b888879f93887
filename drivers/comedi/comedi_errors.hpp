/// \file
/// Errors of a board in words: what it means, what to do.
#pragma once

#include <string>

#include "core/base/result.hpp"

namespace stickslip::drivers {

/// One line for a person: what `error` (errno, > 0) means for this device and what to do.
[[nodiscard]] std::string explain_comedi_error(const std::string& device, int error);

/// The same as an error, of the kind that says who has to act.
[[nodiscard]] base::Error comedi_error(const std::string& device, int error);

}  // namespace stickslip::drivers
