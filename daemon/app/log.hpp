/// \file
/// The daemon's facts as lines of the log.
#pragma once

#include <memory>

#include "io/config.hpp"

#include "daemon/app/log_output.hpp"
#include "daemon/types/facts.hpp"

namespace stickslip::app {

/// \param level  lines below it are left out.
[[nodiscard]] std::unique_ptr<daemon::Facts> make_log(io::LogLevel level,
                                                      std::unique_ptr<LogOutput> output = make_log_output());

}  // namespace stickslip::app
