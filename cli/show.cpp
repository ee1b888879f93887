#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "cli/ask.hpp"
#include "cli/json_members.hpp"
#include "cli/record_json.hpp"
#include "cli/subcommands.hpp"
#include "io/findings_text.hpp"
#include "io/json_text.hpp"
#include "io/results_json.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include "report/budget_forms.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ShowOptions : BenchOptions {
  std::string test;  ///< Number of a test of the daemon, or path of a record.
};

/// "rung: two-parameter-law, the slips begin gradually …"
std::string rung_text(const Json& results) {
  const Json& details = results["details"];
  const std::string reason = details.contains("rung") ? word(details["rung"], "reason") : std::string{};
  return fmt::format("rung: {}{}{}\n", word(results, "rung"), reason.empty() ? "" : ", ", reason);
}

/// Two lines for each finding.
std::string findings_of(const Json& results) {
  std::string text;
  for (const base::Finding& finding : record::findings_in(results)) text += io::finding_text(finding);
  return text;
}

/// "  mu_s  0.3517 ± 0.0004 ± 0.0021", one line for each result; below them, what the errors mean.
std::string results_text(const Json& results) {
  io::Table list = io::Table::list({0, 0});
  bool has_error = false;
  bool has_systematic = false;
  bool all_significant = true;
  for (const auto& [name, detail] : results["details"].items()) {
    if (!detail.contains("value")) continue;
    const analysis::Estimate estimate = io::estimate_in(results, name);
    if (!estimate.value) {
      list.add({"  " + name, fmt::format("{} {}", io::kAbsent, word(detail, "reason"))});
      continue;
    }
    const io::Uncertain number = io::uncertain(estimate, std::nullopt);
    has_error |= !number.standard_error.empty();
    has_systematic |= !number.systematic.empty();
    all_significant &= number.significant;
    const std::string unit = word(detail, "unit");
    const std::string place = detail.contains("place") ? ", most at the " + word(detail, "place") : "";
    list.add({"  " + name, number.text() + (unit == "1" ? "" : " " + unit) + place});
  }
  std::string text = list.text();
  if (has_error || has_systematic)
    text += fmt::format("{}\n", has_systematic ? io::kErrorsLegend : io::kStandardErrorLegend);
  if (!all_significant) text += fmt::format("{}\n", io::kNotSignificantLegend);
  return text;
}

base::Result<std::string> show_test(const ShowOptions& options) {
  const base::Result<Json> test = ask(options, {"GET", "/v1/tests/" + options.test, {}, {}, {}});
  if (!test) return tl::unexpected(test.error());
  if (options.json) return test->dump(2) + "\n";
  const std::string text =
      fmt::format("test {}: {}, ended: {}\nfile: {}\n", (*test)["number"].dump(),
                  word((*test)["results"], "regime"), word(*test, "cause"), word(*test, "file"));
  return text + findings_of((*test)["results"]) + rung_text((*test)["results"]) +
         results_text((*test)["results"]);
}

base::Result<std::string> show_record(const ShowOptions& options) {
  const base::Result<record::Record> record = record::read_record_apart(options.test);
  if (!record) {
    return tl::unexpected(base::Error{
        record.error().kind, record.error().message + "; a test of the daemon is named by its number"});
  }
  const Json json = record_json(options.test, *record);
  if (options.json) return io::json_document(json);
  const Json& results = json["results"];
  io::Table known = io::Table::list({0, 0});
  for (const auto& [name, value] : json["facts"].items())
    known.add({"  " + name, value.is_string() ? base::printable(value.get<std::string>()) : value.dump()});
  for (const auto& [key, value] : record->header.sample.metadata)
    known.add({"  metadata." + base::printable(key), base::printable(value)});
  const std::string budget =
      report::budget_text(report::budgets_of(record->end->results, report::budget_facts_of(record->header)));
  return fmt::format(
      "{}: {}, ended: {}\n{}{}\n{}{}{}", base::printable(options.test), word(results, "regime"),
      record->end->cause.empty() ? std::string{io::kAbsent} : base::printable(record->end->cause),
      findings_of(results), known.text(), rung_text(results), results_text(results),
      budget.empty() ? budget : "\nuncertainty budget\n" + budget);
}

base::Result<std::string> run_show(const ShowOptions& options) {
  const bool is_number =
      !options.test.empty() && options.test.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? show_test(options) : show_record(options);
}

constexpr const char* kShowExamples =
    R"(Examples:
  stickslip show 7                                             a test of the daemon, by its number
  stickslip show pull.h5                                       a record
  stickslip show pull.h5 --json)";

}  // namespace

void add_show(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* command =
      app.add_subcommand("show", "one test of the running daemon, or a record, with all results");
  command->footer(kShowExamples);
  add_bench_options(*command, *options, false);
  command->add_option("test", options->test, "its number, or a record")->required()->type_name("N|FILE.h5");
  choose(*command, chosen, [options] { return run_show(*options); });
}

}  // namespace stickslip::cli
