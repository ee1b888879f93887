/// \file
/// Negotiation of the scan rate: the board may change the request, and the result is read back.
#pragma once

#include <optional>
#include <string>

#include "core/base/result.hpp"
#include "drivers/comedi/comedi_board.hpp"
#include "drivers/comedi/comedi_calls.hpp"

namespace stickslip::drivers {

struct Agreement {
  ComediCommand command;  ///< As the board takes it, unchanged.
  double scan_rate_Hz = 0.0;
  std::string notes;  ///< What the board changed on the way; empty if nothing.
};

/// A command without end whose rate is within the tolerance. Errors name what the board would grant.
[[nodiscard]] base::Result<Agreement> agree_on_command(const ComediBoardSettings& settings,
                                                       unsigned subdevice, unsigned range, ComediCalls& calls,
                                                       const std::optional<ComediInput>& second = {});

/// For a board that is read one scan at a time: the rate is this computer's, to the nanosecond.
[[nodiscard]] base::Result<Agreement> agree_on_polling(const ComediBoardSettings& settings,
                                                       unsigned subdevice, unsigned range,
                                                       const std::optional<ComediInput>& second = {});

}  // namespace stickslip::drivers
