// Subcommands that talk to the running daemon: arm, start, stop, mark, tare, plan, batch, void, list, show,
// watch.

#include <utility>
#include <vector>

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
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

struct KeptBatch {
  BenchOptions options;
  BatchCommand command;
  std::vector<std::pair<std::string, std::shared_ptr<std::string>>> values;
};

void add_batch(CLI::App& app, Chosen& chosen) {
  const auto shown = std::make_shared<Kept>();
  CLI::App* batch = app.add_subcommand("batch", "tests planned together; without more: how far they are");
  batch->footer(kBatchExamples);
  batch->require_subcommand(0, 1);
  add_bench_options(*batch, shown->options, false);
  // The parser calls this after that of a subcommand.
  batch->callback([&chosen, batch, shown] {
    if (batch->get_subcommands().empty())
      chosen.run = [shown] { return print(run_batch_show(shown->options)); };
  });

  const auto kept = std::make_shared<KeptBatch>();
  CLI::App* begin = batch->add_subcommand("begin", "plan tests; the bench leads through them");
  add_bench_options(*begin, kept->options, true);
  for (const auto& [key, what] :
       {std::pair{"name", "of the samples"}, std::pair{"grade", "of the paper"},
        std::pair{"direction", "such as MD"}, std::pair{"side", "such as wire"},
        std::pair{"operator", "who measures"}, std::pair{"method", "one that `stickslip methods` lists"}}) {
    const auto value = std::make_shared<std::string>();
    kept->values.emplace_back(key, value);
    begin->add_option(std::string{"--"} + key, *value, what)->type_name("TEXT");
  }
  begin
      ->add_option("--pull-speed", kept->command.pull_speeds,
                   "with unit; may be repeated. Default: that of the method, else of the bench")
      ->type_name("SPEED");
  begin->add_option("--replicates", kept->command.replicates, "sheets at each speed")->type_name("N");
  begin->add_option("--slides", kept->command.slides, "pulls of each sheet")->type_name("N");
  begin->add_option("--limit", kept->command.limits, "what a result may be, as mu_k=0.2:0.4; may be repeated")
      ->type_name("RESULT=LOWEST:HIGHEST");
  choose(*begin, chosen, [kept] {
    for (const auto& [key, value] : kept->values) {
      if (!value->empty()) kept->command.facts.emplace_back(key, *value);
    }
    return run_batch_begin(kept->options, kept->command);
  });

  const auto ended = std::make_shared<Kept>();
  CLI::App* end = batch->add_subcommand("end", "no more tests of this batch");
  add_bench_options(*end, ended->options, true);
  choose(*end, chosen, [ended] { return run_batch_end(ended->options); });
}

void add_void(CLI::App& app, Chosen& chosen) {
  struct KeptVoid {
    BenchOptions options;
    VoidCommand command;
  };
  const auto kept = std::make_shared<KeptVoid>();
  CLI::App* command = app.add_subcommand(
      "void", "a test does not count: its file stays as it is, statistics leave it out and say so");
  add_bench_options(*command, kept->options, true);
  command->add_option("test", kept->command.test, "its number in the running daemon, or its record")
      ->required()
      ->type_name("N|FILE.h5");
  command->add_option("--reason", kept->command.reason, "such as \"paper torn\"")->type_name("TEXT");
  command->add_flag("--restore", kept->command.restore, "it was voided by mistake: it counts again");
  choose(*command, chosen, [kept] { return run_void(kept->options, kept->command); });
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
  add_batch(app, chosen);
  add_void(app, chosen);
  add_readers(app, chosen);
}

}  // namespace stickslip::cli
