#include "cli/bench_command.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "cli/json_members.hpp"

namespace stickslip::cli {

using Json = nlohmann::ordered_json;

CLI::App* add_bench_command(CLI::App& app, BenchCommand& command, const char* help) {
  CLI::App* parser = app.add_subcommand(command.verb, help);
  add_bench_options(*parser, command, true);
  parser
      ->add_option("--key", command.key,
                   "name of this request: repeated under the same name it is not done twice")
      ->type_name("KEY");
  return parser;
}

base::Result<std::string> run_bench_command(const BenchCommand& command, const Json& body,
                                            const std::function<std::string(const Json&)>& more) {
  const base::Result<std::string> said = body_of(body);
  if (!said) return tl::unexpected(said.error());
  const base::Result<Json> done =
      ask(command, {"POST", "/v1/" + command.verb, body.empty() ? "" : *said, {}, command.key});
  if (!done) return tl::unexpected(done.error());
  if (command.json) return done->dump(2) + "\n";
  return fmt::format("{}: {}; test {}, scan {}{}\n", command.verb, word(*done, "bench"),
                     (*done)["test"].dump(), (*done)["scan"].dump(),
                     (*done)["already"] == true ? " (had been done)" : "") +
         (more ? more(*done) : "");
}

void add_test_command(CLI::App& app, Chosen& chosen, const char* verb, const char* help,
                      const char* examples) {
  struct TestCommand : BenchCommand {
    std::optional<std::int64_t> test;
  };
  const auto options = std::make_shared<TestCommand>();
  options->verb = verb;
  CLI::App* command = add_bench_command(app, *options, help);
  command->footer(examples);
  command
      ->add_option("--test", options->test,
                   "number of the test that is meant: what was done already is not refused")
      ->type_name("N");
  choose(*command, chosen, [options] {
    Json body = Json::object();
    if (options->test) body["test"] = *options->test;
    return run_bench_command(*options, body);
  });
}

}  // namespace stickslip::cli
