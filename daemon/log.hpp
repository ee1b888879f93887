/// \file
/// The daemon's facts as lines of the log.
#pragma once

#include <memory>

#include "daemon/config.hpp"
#include "daemon/facts.hpp"
#include "daemon/log_output.hpp"

namespace stickslip::daemon {

/// \param level  lines below it are left out.
[[nodiscard]] std::unique_ptr<Facts> make_log(LogLevel level,
                                              std::unique_ptr<LogOutput> output = make_log_output());

}  // namespace stickslip::daemon
