/// \file
/// Messages for errors of a board, with remedies.
#pragma once

#include <string>

#include "core/base/result.hpp"

namespace stickslip::drivers {

/// One line for a person: what `error` (errno, > 0) means for this device and what to do.
[[nodiscard]] std::string explain_comedi_error(const std::string& device, int error);

/// explain_comedi_error() as an Error of the matching kind.
[[nodiscard]] base::Error comedi_error(const std::string& device, int error);

}  // namespace stickslip::drivers
