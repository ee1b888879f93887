/// \file
/// Keys of the plan as options of `stickslip plan` and `stickslip batch begin`.
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace stickslip::cli {

struct PlanKey {
  const char* key;  ///< As the API has it.
  const char* help;
  std::string typed = {};  ///< Empty: not given.
};

/// --pull-speed for pull_speed. \param keys  outlive the parser's run.
inline void add_plan_keys(CLI::App& command, std::span<PlanKey> keys) {
  for (PlanKey& key : keys) {
    std::string option = std::string{"--"} + key.key;
    std::replace(option.begin(), option.end(), '_', '-');
    command.add_option(option, key.typed, key.help)->type_name("TEXT");
  }
}

}  // namespace stickslip::cli
