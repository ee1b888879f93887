#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/ask.hpp"
#include "cli/json_members.hpp"
#include "cli/subcommands.hpp"
#include "io/findings_text.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finding_json.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

base::Result<std::string> run_list(const BenchOptions& options) {
  const base::Result<Json> list = ask(options, {"GET", "/v1/tests", {}, {}, {}});
  if (!list) return tl::unexpected(list.error());
  if (options.json) return list->dump(2) + "\n";
  using enum io::Table::Align;
  io::Table table{{{.heading = "test"},
                   {.heading = "regime", .align = kLeft},
                   {.heading = "S - K"},
                   {.heading = "S"},
                   {.heading = "K"},
                   {.heading = "cycles"},
                   {.heading = "ended", .align = kLeft},
                   {.heading = "file", .align = kLeft}}};
  std::vector<std::vector<base::Finding>> findings;
  for (const Json& test : (*list)["tests"]) {
    const Json& results = test["results"];
    table.add({test["number"].get<std::int64_t>(), word(results, "regime"), coefficient(results, "delta_mu"),
               coefficient(results, "mu_s"), coefficient(results, "mu_k"), number(results, "cycle_count", 0),
               word(test, "cause"), word(test, "file")});
    findings.push_back(record::findings_in(results));
  }
  std::vector<io::TestFindings> told;
  for (std::size_t i = 0; i < findings.size(); ++i)
    told.push_back({(*list)["tests"][i]["number"].get<std::int64_t>(), findings[i]});
  return table.text() + io::findings_text(told);
}

constexpr const char* kListExamples =
    R"(Examples:
  stickslip list
  stickslip list --json
  stickslip list --socket /run/stickslip/control.sock)";

}  // namespace

void add_list(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("list", "list the tests of the running daemon");
  command->footer(kListExamples);
  add_bench_options(*command, *options, false);
  choose(*command, chosen, [options] { return run_list(*options); });
}

}  // namespace stickslip::cli
