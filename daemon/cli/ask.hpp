/// \file
/// One request to the running daemon.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/control/http.hpp"

namespace stickslip::daemon {

/// "ada@bench-pc": who commands, unless somebody says otherwise.
[[nodiscard]] std::string user_name();

/// The answer of a request that was granted; else why it was refused.
[[nodiscard]] base::Result<nlohmann::ordered_json> ask(const BenchOptions& options, HttpRequest request);

}  // namespace stickslip::daemon
