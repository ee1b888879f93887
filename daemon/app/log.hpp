/// \file
/// Writes the daemon's events to the log.
#pragma once

#include <memory>

#include "io/config.hpp"

#include "daemon/app/log_output.hpp"
#include "daemon/types/event_receiver.hpp"

namespace stickslip::app {

/// Makes the receiver of events that logs them. \param level  less important lines are omitted.
[[nodiscard]] std::unique_ptr<daemon::EventReceiver> make_log(
    io::LogLevel level, std::unique_ptr<LogOutput> output = make_log_output());

}  // namespace stickslip::app
