/// \file
/// What of a program's commands its manual shows.
#pragma once

#include <vector>

#include <CLI/CLI.hpp>

namespace stickslip::manual {

/// The subcommands that are not hidden (of an empty group), in their order.
[[nodiscard]] inline std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

}  // namespace stickslip::manual
