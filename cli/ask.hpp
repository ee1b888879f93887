/// \file
/// One request to the running daemon.
#pragma once

#include <string>

#include "cli/commands.hpp"
#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::cli {

/// "ada@bench-pc": who commands, unless somebody says otherwise.
[[nodiscard]] std::string user_name();

/// The answer of a request that was granted; else why it was refused.
[[nodiscard]] base::Result<nlohmann::ordered_json> ask(const BenchOptions& options,
                                                       daemon::HttpRequest request);

}  // namespace stickslip::cli
