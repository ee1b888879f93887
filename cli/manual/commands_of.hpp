/// \file
/// Selects the commands that a manual shows.
#pragma once

#include <vector>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// The subcommands in their order, without hidden ones (those in an empty group).
[[nodiscard]] inline std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

}  // namespace stickslip::manual
