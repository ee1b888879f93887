/// \file
/// One request to the running daemon, and the options of all commands that talk to it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"
#include "daemon/types/http.hpp"

namespace stickslip::cli {

struct BenchOptions {
  std::string socket = "/run/stickslip/control.sock";
  std::string who;  ///< Empty: user and host.
  bool json = false;
};

/// \param commands  whether they change anything: then somebody is named who does.
void add_bench_options(CLI::App& command, BenchOptions& options, bool commands);

/// "ada@bench-pc": who commands, unless somebody says otherwise.
[[nodiscard]] std::string user_name();

/// The answer of a request that was granted; else why it was refused.
[[nodiscard]] base::Result<nlohmann::ordered_json> ask(const BenchOptions& options,
                                                       daemon::HttpRequest request);

}  // namespace stickslip::cli
