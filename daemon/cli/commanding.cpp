// Subcommands that talk to the running daemon: arm, start, stop, mark, tare, plan, list, show, watch.

#include <utility>
#include <vector>

#include "daemon/cli/commands.hpp"
#include "daemon/cli/subcommands.hpp"

namespace stickslip::daemon {
namespace {

void add_bench_options(CLI::App& command, BenchOptions& options, bool commands) {
  command.add_option("--socket", options.socket, "the daemon's control socket")
      ->capture_default_str()
      ->type_name("PATH");
  command.add_flag("--json", options.json, "JSON instead of text");
  if (commands) {
    command
        .add_option("--as", options.who,
                    "who commands; default: user@host. Others are refused for half a minute")
        ->type_name("NAME");
  }
}

struct Kept {
  BenchOptions options;
  BenchCommand command;
  PlanCommand plan;
  std::vector<std::pair<std::string, std::shared_ptr<std::string>>> values;
  std::int64_t number = 0;
};

CLI::App* add_command(CLI::App& app, Chosen& chosen, const std::shared_ptr<Kept>& kept, const char* verb,
                      const char* what) {
  kept->command.verb = verb;
  CLI::App* command = app.add_subcommand(verb, what);
  add_bench_options(*command, kept->options, true);
  command
      ->add_option("--key", kept->command.key,
                   "of this request: repeated with the same key it is not done twice")
      ->type_name("KEY");
  choose(*command, chosen, [kept] { return run_bench_command(kept->options, kept->command); });
  return command;
}

void add_commands(CLI::App& app, Chosen& chosen) {
  add_command(app, chosen, std::make_shared<Kept>(), "arm", "the force may begin the next test");
  for (const auto& [verb, what] : {std::pair{"start", "begin a test with the next scan, whatever the force"},
                                   std::pair{"stop", "end the running test; an armed bench is idle then"}}) {
    const auto kept = std::make_shared<Kept>();
    add_command(app, chosen, kept, verb, what)
        ->add_option("--test", kept->command.test,
                     "number of the test that is meant: what was done already is not refused")
        ->type_name("N");
  }
  const auto kept = std::make_shared<Kept>();
  add_command(app, chosen, kept, "mark", "write a remark into the record of the running test")
      ->add_option("text", kept->command.text, "the remark")
      ->required()
      ->type_name("TEXT");
  add_command(app, chosen, std::make_shared<Kept>(), "tare",
              "make what the unloaded load cell shows now its zero");
}

void add_plan(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<Kept>();
  CLI::App* plan = app.add_subcommand("plan", "say what the tests to come are of; without options: show it");
  add_bench_options(*plan, kept->options, true);
  plan->add_flag("--clear", kept->plan.clear, "forget what was said before");
  for (const auto& [key, what] : {std::pair{"name", "of the sample"}, std::pair{"grade", "of the paper"},
                                  std::pair{"direction", "such as MD"}, std::pair{"side", "such as wire"},
                                  std::pair{"operator", "who measures"}, std::pair{"replicate", "from 1"},
                                  std::pair{"pull_speed", "with unit: \"12 in/min\""}}) {
    const auto value = std::make_shared<std::string>();
    kept->values.emplace_back(key, value);
    std::string option = std::string{"--"} + key;
    for (char& c : option) c = c == '_' ? '-' : c;
    plan->add_option(option, *value, what)->type_name("TEXT");
  }
  choose(*plan, chosen, [kept] {
    for (const auto& [key, value] : kept->values) {
      if (value->empty()) continue;
      // A bare number is in m/s, as in all of the command line.
      kept->plan.changes.emplace_back(key, *value);
    }
    return run_plan(kept->options, kept->plan);
  });
}

void add_readers(CLI::App& app, Chosen& chosen) {
  const auto listed = std::make_shared<Kept>();
  CLI::App* list = app.add_subcommand("list", "the tests of the running daemon");
  add_bench_options(*list, listed->options, false);
  choose(*list, chosen, [listed] { return run_list(listed->options); });

  const auto shown = std::make_shared<Kept>();
  CLI::App* show = app.add_subcommand("show", "one test of the running daemon, with all results");
  add_bench_options(*show, shown->options, false);
  show->add_option("test", shown->number, "its number")->required()->type_name("N");
  choose(*show, chosen, [shown] { return run_show(shown->options, shown->number); });

  const auto watched = std::make_shared<Kept>();
  CLI::App* watch =
      app.add_subcommand("watch", "what happens, as it happens: tests, cycles, gaps; until Ctrl-C");
  add_bench_options(*watch, watched->options, false);
  watch->add_option("--tests", watched->number, "leave when so many tests have ended")->type_name("N");
  choose(*watch, chosen, [watched] { return run_watch(watched->options, watched->number); });
}

}  // namespace

void add_commanding_commands(CLI::App& app, Chosen& chosen) {
  add_commands(app, chosen);
  add_plan(app, chosen);
  add_readers(app, chosen);
}

}  // namespace stickslip::daemon
