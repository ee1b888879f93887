#include <array>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/ask.hpp"
#include "cli/batch_text.hpp"
#include "cli/json_members.hpp"
#include "cli/plan_keys.hpp"
#include "cli/subcommands.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/results.hpp"
#include "core/base/wording.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BatchBeginOptions : BenchOptions {
  std::array<PlanKey, 6> keys{{{"name", "of the samples"},
                               {"grade", "of the paper"},
                               {"direction", "such as MD"},
                               {"side", "such as wire"},
                               {"operator", "who measures"},
                               {"method", "one that `stickslip methods` lists"}}};
  std::vector<std::string> pull_speeds;
  std::optional<std::int64_t> replicates;
  std::optional<std::int64_t> slides;
  std::vector<std::string> facts;
  std::vector<std::string> limits;  ///< "mu_k=0.2:0.4"; either side may be absent.
};

std::optional<double> number_in(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "mu_k=0.2:0.4", "period_median=1 s:2 s" into the plan's limits. Text with a unit is left to the daemon.
base::Result<void> add_limit(Json& limits, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':', equals == std::string::npos ? 0 : equals);
  const auto wrong = [&text] {
    return base::usage_error("--limit {0}: must be RESULT=LOWEST:HIGHEST, such as {1}=0.2:0.4 or {1}=:0.4",
                             text, text.substr(0, text.find('=')));
  };
  // What the daemon would refuse is refused here too, with the names.
  const std::string name = text.substr(0, equals);
  std::set<std::string, std::less<>> known;
  const analysis::TestResults none;
  analysis::for_each_result(none, [&known](const analysis::ResultName& result, const analysis::Estimate&) {
    known.insert(std::string{result.name});
  });
  if (!known.contains(name)) {
    // Names of the trade for the coefficients.
    const bool is_cof = name == "cof" || name == "COF" || name == "mu";
    return base::usage_error(
        "--limit {}: there is no result called \"{}\"; {}", text, base::one_line(name),
        is_cof ? "the coefficients of friction are static_coefficient and kinetic_coefficient"
               : base::spelling_hint(name, known));
  }
  if (equals == std::string::npos || colon == std::string::npos) return wrong();
  Json limit = Json::object();
  for (const auto& [side, typed] : {std::pair{"lowest", text.substr(equals + 1, colon - equals - 1)},
                                    {"highest", text.substr(colon + 1)}}) {
    if (typed.empty()) continue;
    const auto value = number_in(typed);
    if (!value && typed.find_first_of("0123456789") == std::string::npos) return wrong();
    limit[side] = value ? Json(*value) : Json(typed);
  }
  limits[text.substr(0, equals)] = std::move(limit);
  return {};
}

base::Result<std::string> begin_batch(const BatchBeginOptions& options) {
  Json plan = Json::object();
  for (const PlanKey& key : options.keys) {
    if (!key.typed.empty()) plan[key.key] = key.typed;
  }
  if (const auto set = set_facts(plan, options.facts); !set) return tl::unexpected(set.error());
  const Json facts = plan.value("facts", Json::object());
  for (const auto& [key, value] : facts.items()) {
    if (value.is_null())
      return base::usage_error(
          "--fact {0}=: the value is empty; to forget it, first: stickslip plan --fact {0}=", key);
  }
  if (!options.pull_speeds.empty()) plan["pull_speeds"] = options.pull_speeds;
  if (options.replicates) plan["replicates"] = *options.replicates;
  if (options.slides) plan["slides"] = *options.slides;
  Json limits = Json::object();
  for (const std::string& limit : options.limits) {
    if (const auto added = add_limit(limits, limit); !added) return tl::unexpected(added.error());
  }
  if (!limits.empty()) plan["limits"] = std::move(limits);
  const base::Result<std::string> said = body_of(plan);
  if (!said) return tl::unexpected(said.error());
  return batch_output(options, ask(options, {"POST", "/v1/batch", *said, {}, {}}));
}

constexpr const char* kBeginExamples = R"(Examples:
  stickslip batch begin --name "liner 42" --method tappi-t549 --replicates 5 --slides 3
  stickslip batch begin --name "liner 42" --pull-speed "6 in/min" --pull-speed "12 in/min" --replicates 3
  stickslip batch begin --name "liner 42" --replicates 5 --limit mu_k=0.25:0.40 --limit static_coefficient=:0.5)";

constexpr const char* kEndExamples = R"(Examples:
  stickslip batch end
  stickslip batch end --as ann
  stickslip batch end --json)";

void add_batch_begin(CLI::App& batch, Chosen& chosen) {
  const auto options = std::make_shared<BatchBeginOptions>();
  CLI::App* command = batch.add_subcommand("begin", "plan tests; the bench leads through them");
  add_bench_options(*command, *options, true);
  command->footer(kBeginExamples);
  add_plan_keys(*command, options->keys);
  add_fact_option(*command, options->facts);
  command
      ->add_option("--pull-speed", options->pull_speeds,
                   "with unit; may be repeated. Default: that of the method, else of the bench")
      ->type_name("SPEED");
  command->add_option("--replicates", options->replicates, "sheets at each speed")->type_name("N");
  command->add_option("--slides", options->slides, "pulls of each sheet")->type_name("N");
  command
      ->add_option(
          "--limit", options->limits,
          "range that a result has to keep, as mu_k=0.2:0.4 or \"period_median=1 s:2 s\"; may be repeated")
      ->type_name("RESULT=LOWEST:HIGHEST");
  choose(*command, chosen, [options] { return begin_batch(*options); });
}

void add_batch_end(CLI::App& batch, Chosen& chosen) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* command = batch.add_subcommand("end", "end the batch: it gets no more tests");
  command->footer(kEndExamples);
  add_bench_options(*command, *options, true);
  choose(*command, chosen, [options] {
    return batch_output(*options, ask(*options, {"DELETE", "/v1/batch", {}, {}, {}}));
  });
}

constexpr const char* kBatchExamples =
    R"(A batch plans its tests: at each speed so many sheets, each pulled so many times. The daemon leads from test to test, also
after a restart; what is voided is asked for again.

Examples:
  stickslip batch begin --name "liner 42" --method tappi-t549 --replicates 5 --slides 3
  stickslip batch begin --name "liner 42" --pull-speed "6 in/min" --pull-speed "12 in/min" --replicates 3 --limit mu_k=0.25:0.40
  stickslip batch                                       how far it is, and what comes next
  stickslip void 7 --reason "paper torn"                the file stays, statistics leave it out
  stickslip report --batch "liner 42" records -o liner-42.html
  stickslip batch end)";

}  // namespace

void add_batch(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* command =
      app.add_subcommand("batch", "plan tests together; without a subcommand: show how far they are");
  command->footer(kBatchExamples);
  command->require_subcommand(0, 1);
  add_bench_options(*command, *options, false);
  // The parser calls this after that of a subcommand.
  command->callback([&chosen, command, options] {
    if (!command->get_subcommands().empty()) return;
    chosen.run = [options] {
      return print(batch_output(*options, ask(*options, {"GET", "/v1/batch", {}, {}, {}})));
    };
  });
  add_batch_begin(*command, chosen);
  add_batch_end(*command, chosen);
}

}  // namespace stickslip::cli
