/// \file
/// The daemon's facts as log lines on stderr.
#pragma once

#include <memory>

#include "daemon/config.hpp"
#include "daemon/facts.hpp"

namespace stickslip::daemon {

/// With time and level for people; under journald (JOURNAL_STREAM is set) with the level as
/// sd-daemon(3) prefix and without time.
[[nodiscard]] std::unique_ptr<Facts> make_log(LogLevel level);

}  // namespace stickslip::daemon
