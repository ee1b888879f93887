#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/ask.hpp"
#include "cli/json_members.hpp"
#include "cli/options.hpp"
#include "cli/plan_keys.hpp"
#include "cli/subcommands.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct PlanOptions : BenchOptions {
  bool clear = false;
  std::vector<std::string> facts;
  std::array<PlanKey, 7> keys{{{"name", "of the sample"},
                               {"grade", "of the paper"},
                               {"direction", "such as MD"},
                               {"side", "such as wire"},
                               {"operator", "who measures"},
                               {"replicate", "from 1"},
                               {"pull_speed", "with unit: \"12 in/min\""}}};
};

/// A speed is sent as text with its unit.
base::Result<Json> plan_value(std::string_view key, const std::string& typed) {
  if (key == "pull_speed") {
    const auto speed = number_of("--pull-speed", typed, base::Dimension::kSpeed, true);
    if (!speed) return tl::unexpected(speed.error());
    return Json(base::format_quantity(speed->value_or(0.0), base::Dimension::kSpeed));
  }
  if (key != "replicate") return Json(typed);
  Json parsed = Json::parse(typed, nullptr, false);
  return parsed.is_discarded() ? Json(typed) : parsed;
}

base::Result<std::string> run_plan(const PlanOptions& options) {
  base::Result<Json> plan = ask(options, {"GET", "/v1/plan", {}, {}, {}});
  if (!plan) return tl::unexpected(plan.error());
  if (options.clear) plan = Json::object();
  bool changed = options.clear;
  for (const PlanKey& key : options.keys) {
    if (key.typed.empty()) continue;
    base::Result<Json> value = plan_value(key.key, key.typed);
    if (!value) return tl::unexpected(value.error());
    (*plan)[key.key] = *std::move(value);
    changed = true;
  }
  if (const auto set = set_facts(*plan, options.facts); !set) return tl::unexpected(set.error());
  if (changed || !options.facts.empty()) {
    // What the daemon has is sent back with its unit.
    if (const auto speed = plan->find("pull_speed"); speed != plan->end() && speed->is_number())
      *speed = base::format_quantity(speed->get<double>(), base::Dimension::kSpeed);
    const base::Result<std::string> said = body_of(*plan);
    if (!said) return tl::unexpected(said.error());
    plan = ask(options, {"PUT", "/v1/plan", *said, {}, {}});
    if (!plan) return tl::unexpected(plan.error());
  }
  if (options.json) return plan->dump(2) + "\n";
  io::Table list = io::Table::list({0, 0});
  for (const auto& [key, value] : plan->items()) {
    if (key == "facts") continue;
    std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_null()) shown = io::kAbsent;
    if (key == "pull_speed" && value.is_number()) shown = fmt::format("{:.6g} m/s", value.get<double>());
    list.add({key, shown});
  }
  const Json facts = plan->value("facts", Json::object());
  for (const auto& [key, value] : facts.items()) list.add({"fact " + key, value.get<std::string>()});
  return list.text();
}

constexpr const char* kPlanExamples =
    R"(Examples:
  stickslip plan                                               what is planned
  stickslip plan --name "liner 42" --grade kraft --direction MD --operator ann
  stickslip plan --fact "temperature=23 degC" --fact "humidity=50 %" --fact lot=4711
  stickslip plan --fact lot=                                   forget the lot
  stickslip plan --clear)";

}  // namespace

void add_plan(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App* command = app.add_subcommand(
      "plan", "set sample, operator, pull speed and facts of the next tests; without options: show them");
  command->footer(kPlanExamples);
  add_bench_options(*command, *options, true);
  command->add_flag("--clear", options->clear, "forget what was said before");
  add_plan_keys(*command, options->keys);
  add_fact_option(*command, options->facts);
  choose(*command, chosen, [options] { return run_plan(*options); });
}

}  // namespace stickslip::cli
