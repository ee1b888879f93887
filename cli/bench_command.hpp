/// \file
/// What arm, start, stop, mark and tare have in common: one request to the bench, and its answer as a line.
#pragma once

#include <functional>
#include <string>

#include "cli/ask.hpp"
#include "cli/subcommands.hpp"
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

struct BenchCommand : BenchOptions {
  std::string verb;  ///< As it is typed, and in the API's path.
  std::string key;   ///< Idempotency-Key; empty: none.
};

/// `stickslip VERB` with the options of BenchCommand.
/// \param help  what it does. \param command  has the verb; gets the rest.
CLI::App* add_bench_command(CLI::App& app, BenchCommand& command, const char* help);

/// POST /v1/VERB. \param body  empty: none. \param more  lines for people about the answer, below the first.
[[nodiscard]] base::Result<std::string> run_bench_command(
    const BenchCommand& command, const nlohmann::ordered_json& body,
    const std::function<std::string(const nlohmann::ordered_json&)>& more = {});

/// A bench command with --test, as start and stop are.
void add_test_command(CLI::App& app, Chosen& chosen, const char* verb, const char* help,
                      const char* examples);

}  // namespace stickslip::cli
