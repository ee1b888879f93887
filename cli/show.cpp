#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>

#include "cli/ask.hpp"
#include "cli/json_members.hpp"
#include "cli/subcommands.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ShowOptions : BenchOptions {
  std::int64_t test = 0;  ///< Its number.
};

base::Result<std::string> run_show(const ShowOptions& options) {
  const base::Result<Json> test =
      ask(options, {"GET", fmt::format("/v1/tests/{}", options.test), {}, {}, {}});
  if (!test) return tl::unexpected(test.error());
  if (options.json) return test->dump(2) + "\n";
  const std::string text =
      fmt::format("test {}: {}, ended: {}\nfile: {}\n", (*test)["number"].dump(),
                  word((*test)["results"], "regime"), word(*test, "cause"), word(*test, "file"));
  io::Table list = io::Table::list({0, 0});
  for (const auto& [name, detail] : (*test)["results"]["details"].items()) {
    if (!detail.contains("value")) continue;
    const Json& value = detail["value"];
    const std::string error = detail.contains("standard_error")
                                  ? fmt::format(" ± {:.2g}", detail["standard_error"].get<double>())
                                  : "";
    const std::string unit = word(detail, "unit");
    list.add({"  " + name, value.is_null() ? fmt::format("{} {}", io::kAbsent, word(detail, "reason"))
                                           : fmt::format("{:.6g}{}{}", value.get<double>(), error,
                                                         unit == "1" ? "" : " " + unit)});
  }
  return text + list.text();
}

}  // namespace

void add_show(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* command = app.add_subcommand("show", "one test of the running daemon, with all results");
  add_bench_options(*command, *options, false);
  command->add_option("test", options->test, "its number")->required()->type_name("N");
  choose(*command, chosen, [options] { return run_show(*options); });
}

}  // namespace stickslip::cli
