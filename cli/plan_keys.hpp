/// \file
/// Keys of the plan and facts as options of `stickslip plan` and `stickslip batch begin`.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/base/result.hpp"
#include "core/record/metadata.hpp"

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

/// --fact KEY=VALUE. \param facts  outlive the parser's run.
inline void add_fact_option(CLI::App& command, std::vector<std::string>& facts) {
  command
      .add_option(
          "--fact", facts,
          "of the tests: temperature, humidity, conditioning, contact_time, lot or a key of your own, "
          "quantities with unit: \"temperature=23 degC\"; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// Sets what --fact gave in the "facts" of a plan. Errors: kUsage, also for what the daemon would refuse.
[[nodiscard]] inline base::Result<void> set_facts(nlohmann::ordered_json& plan,
                                                  const std::vector<std::string>& facts) {
  for (const std::string& text : facts) {
    const auto fact = record::split_fact(text);
    record::Metadata checked;
    const auto known = fact ? record::set_fact(checked, fact->first, fact->second)
                            : base::Result<void>{tl::unexpected(fact.error())};
    if (!known) return base::usage_error("--fact: {}", known.error().message);
    plan["facts"][fact->first] =
        fact->second.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(fact->second);
  }
  return {};
}

}  // namespace stickslip::cli
