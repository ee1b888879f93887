#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/paint.hpp"
#include "cli/progress.hpp"
#include "cli/subcommands.hpp"
#include "io/catalogue/catalogue.hpp"
#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include "io/print_text.hpp"
#include "io/results_json.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/record/iso_time.hpp"
#include "daemon/types/batch_json.hpp"
#include "daemon/types/voidings.hpp"

namespace stickslip::cli {
namespace {

using base::Result;
using catalogue::Entry;
using catalogue::Found;
using Json = nlohmann::ordered_json;

struct FindOptions {
  std::string folder = ".";
  std::string from;
  std::string to;
  std::vector<std::string> samples;
  std::vector<std::string> grades;
  std::vector<std::string> operators;
  std::vector<std::string> batches;
  std::vector<std::string> methods;
  std::vector<std::string> regimes;
  std::vector<std::string> findings;
  std::vector<std::string> ranges;
  std::vector<std::string> facts;
  std::string sort = "date";
  bool reversed = false;
  std::optional<std::int64_t> most;
  bool wide = false;
  bool unread = false;
  bool paths = false;
  bool paths0 = false;
  bool json = false;
  bool csv = false;
};

constexpr int kNothingFound = 3;
constexpr int kDecimalsOfFind = 4;

Result<catalogue::Query> query_of(const FindOptions& options) {
  catalogue::Query query;
  const auto both = [&](const Result<catalogue::Condition>& condition) -> Result<void> {
    if (!condition) return tl::unexpected(condition.error());
    query.conditions.push_back(*condition);
    return {};
  };
  std::optional<catalogue::Moment> from;
  std::optional<catalogue::Moment> to;
  for (const auto& [text, place, moment] :
       {std::tuple{&options.from, "--from", &from}, {&options.to, "--to", &to}}) {
    if (text->empty()) continue;
    const Result<catalogue::Moment> typed = catalogue::moment_from_text(*text, place);
    if (!typed) return tl::unexpected(typed.error());
    *moment = *typed;
  }
  if (from || to) query.conditions.push_back(catalogue::begins_in(from, to));
  using enum catalogue::Text;
  for (const auto& [text, patterns] : {std::pair{kSample, &options.samples},
                                       {kGrade, &options.grades},
                                       {kOperator, &options.operators},
                                       {kBatch, &options.batches},
                                       {kMethod, &options.methods}}) {
    if (!patterns->empty()) query.conditions.push_back(catalogue::is_like(text, *patterns));
  }
  if (!options.regimes.empty()) {
    if (auto known = both(catalogue::has_regime(options.regimes, "--regime")); !known)
      return tl::unexpected(known.error());
  }
  if (!options.findings.empty()) {
    if (auto known = both(catalogue::has_finding(options.findings, "--finding")); !known)
      return tl::unexpected(known.error());
  }
  for (const std::string& range : options.ranges) {
    if (auto known = both(catalogue::in_range(range, "--where")); !known)
      return tl::unexpected(known.error());
  }
  for (const std::string& fact : options.facts) {
    if (auto known = both(catalogue::has_fact(fact, "--fact")); !known) return tl::unexpected(known.error());
  }
  const Result<std::string> order = catalogue::sort_column(options.sort, "--sort");
  if (!order) return tl::unexpected(order.error());
  query.order = *order;
  query.reversed = options.reversed;
  query.most = options.most;
  return query;
}

/// As a program takes it that was started where this one was.
std::string path_of(const FindOptions& options, const std::string& file) {
  std::string path = options.folder == "." ? file : (std::filesystem::path{options.folder} / file).string();
  return path.starts_with('-') ? "./" + path : path;  // Or it would be taken for an option.
}

std::string why_unread(const catalogue::UnreadFile& file) {
  return (file.state == catalogue::State::kNotLooked ? "cannot look: " : "unreadable: ") + file.why;
}

std::string missing_text(const Found& found) {
  return fmt::format("{} of {} files could not be read and are missing here: --unread says why",
                     found.unread.size(), found.followed.file_count);
}

std::string text_of(const FindOptions& options, const Found& found) {
  using enum io::Table::Align;
  std::vector<io::Table::Column> columns{{.heading = "n"},
                                         {.heading = "date", .align = kLeft},
                                         {.heading = "sample", .align = kLeft},
                                         {.heading = "regime", .align = kLeft},
                                         {.heading = "S−K"},
                                         {.heading = "S"},
                                         {.heading = "K"}};
  if (options.wide) columns.push_back({.heading = "file", .align = kLeft});
  io::Table table{std::move(columns)};
  bool all_significant = true;
  const auto number = [&](const analysis::Estimate& estimate) -> io::Table::Cell {
    if (!estimate.value) return {};
    const io::Uncertain shown = io::uncertain(estimate, kDecimalsOfFind);
    all_significant &= shown.significant;
    return options.wide ? shown.text() : shown.value;
  };
  constexpr std::size_t kSampleSize = 14;
  std::int64_t n = 0;
  for (const Entry& entry : found.entries) {
    const analysis::TestResults& results = entry.results;
    std::vector<io::Table::Cell> cells{
        ++n,
        entry.start_realtime_ns ? catalogue::local_minute(*entry.start_realtime_ns) : "",
        options.wide ? entry.sample.name : base::one_line(entry.sample.name, kSampleSize),
        std::string{model::name(results.regime)},
        number(results.delta_mu),
        number(results.mu_s),
        number(results.mu_k)};
    if (options.wide) cells.emplace_back(path_of(options, entry.file));
    table.add(std::move(cells));
  }
  std::string text = found.entries.empty() ? "no record is found\n" : table.text();
  if (options.wide && !found.entries.empty()) text += fmt::format("{}\n", io::kErrorsLegend);
  if (!options.wide && !found.entries.empty()) text += "errors and files: --wide; files alone: --paths\n";
  if (!all_significant) text += fmt::format("{}\n", io::kNotSignificantLegend);
  if (const std::size_t rest = found.match_count - found.entries.size(); rest > 0)
    text += fmt::format("{} more of {} records are not shown: --most\n", rest, found.match_count);
  if (options.unread) {
    for (const catalogue::UnreadFile& file : found.unread)
      text += fmt::format("{}: {}\n", base::printable(path_of(options, file.file)),
                          base::printable(why_unread(file)));
  } else if (!found.unread.empty()) {
    text += missing_text(found) + "\n";
  }
  return text;
}

std::string missing_text(const io::UnreadFolder& folder) {
  return fmt::format("{}: {}: its records are missing here", folder.folder.string(), folder.why);
}

Json json_of(const FindOptions& options, const Found& found) {
  daemon::Voidings voidings;
  std::vector<std::string> notices = found.notices;
  for (const io::UnreadFolder& folder : found.unread_folders) notices.push_back(missing_text(folder));
  // Of a journal that cannot be read it is not known what it voids; once for each of its records would be too
  // often.
  const auto voiding = [&](const std::string& file) -> Json {
    const auto voided = voidings.of(std::filesystem::path{options.folder} / file);
    if (voided) return daemon::voiding_json(*voided ? &**voided : nullptr);
    std::string notice = fmt::format("{}; whether its tests are void is not known", voided.error().message);
    if (std::find(notices.begin(), notices.end(), notice) == notices.end())
      notices.push_back(std::move(notice));
    return nullptr;
  };
  Json records = Json::array();
  for (const Entry& entry : found.entries) {
    const record::SampleFacts& sample = entry.sample;
    records.push_back(
        {{"file", path_of(options, entry.file)},
         {"record", entry.file},
         {"voided", voiding(entry.file)},
         {"start_time", entry.start_realtime_ns ? Json(record::iso_time(*entry.start_realtime_ns)) : Json()},
         {"title", io::or_null(entry.title)},
         {"uuid", io::or_null(entry.uuid)},
         {"status", io::or_null(entry.status)},
         {"sample", io::or_null(sample.name)},
         {"grade", io::or_null(sample.grade)},
         {"direction", io::or_null(sample.direction)},
         {"side", io::or_null(sample.side)},
         {"replicate", io::or_null(sample.replicate)},
         {"slide", io::or_null(sample.slide)},
         {"batch", io::or_null(sample.batch)},
         {"operator", io::or_null(sample.operator_name)},
         {"method", io::or_null(entry.method)},
         {"facts", sample.metadata},
         {"results", io::results_json(entry.results, false)}});
  }
  Json unread = Json::array();
  for (const catalogue::UnreadFile& file : found.unread) {
    unread.push_back({{"file", path_of(options, file.file)},
                      {"looked", file.state == catalogue::State::kUnreadable},
                      {"why", file.why}});
  }
  return {{"records", std::move(records)},
          {"count", found.match_count},
          {"unread", std::move(unread)},
          {"notices", std::move(notices)}};
}

std::string csv_of(const FindOptions& options, const Found& found) {
  std::vector<io::Table::Column> columns;
  for (const char* const name :
       {"file", "start_time", "sample", "grade", "operator", "batch", "method", "regime", "findings"})
    columns.push_back({.name = name});
  const analysis::TestResults none;
  analysis::for_each_result(none, [&](const analysis::ResultName& name, const analysis::Estimate&) {
    for (const char* const part : {"", "_standard_error", "_systematic_uncertainty"})
      columns.push_back({.name = std::string{name.name} + part});
  });
  io::Table table{std::move(columns)};
  for (const Entry& entry : found.entries) {
    std::string codes;
    for (const base::Finding& finding : entry.results.findings)
      codes += (codes.empty() ? "" : " ") + finding.code;
    std::vector<io::Table::Cell> cells{
        path_of(options, entry.file),
        entry.start_realtime_ns ? record::iso_time(*entry.start_realtime_ns) : "",
        entry.sample.name,
        entry.sample.grade,
        entry.sample.operator_name,
        entry.sample.batch,
        entry.method,
        std::string{model::name(entry.results.regime)},
        codes};
    analysis::for_each_result(
        entry.results, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
          for (const auto& part : {estimate.value, estimate.standard_error, estimate.systematic_uncertainty})
            cells.push_back(io::cell(part));
        });
    table.add(std::move(cells));
  }
  return table.csv();
}

void print_paths(const FindOptions& options, const Found& found) {
  std::string text;
  std::size_t left_out = 0;
  for (const Entry& entry : found.entries) {
    const std::string path = path_of(options, entry.file);
    if (!options.paths0 && base::printable(path) != path) {  // It would name another file, or two.
      ++left_out;
      continue;
    }
    text += path;
    text += options.paths0 ? '\0' : '\n';
  }
  if (left_out > 0) {
    io::print_error("stickslip", fmt::format("warning: {} of {} files have names that cannot be printed on a "
                                             "line, and are left out: use -0",
                                             left_out, found.entries.size()));
  }
  // For a program, with each byte of a name.
  if (options.paths0) {
    io::print_bytes(stdout, text);
  } else {
    io::print_text(stdout, text);
  }
}

Result<Found> run_search(const FindOptions& options) {
  const Result<catalogue::Query> query = query_of(options);
  if (!query) return tl::unexpected(query.error());
  std::optional<ProgressBar> bar;
  return catalogue::search(options.folder, *query, [&bar](std::size_t done, std::size_t count) {
    if (!bar) bar.emplace("reading records");
    bar->show(static_cast<double>(done) / static_cast<double>(count), fmt::format("{} of {}", done, count));
  });
}

int run_find(const FindOptions& options) {
  const Result<Found> found = run_search(options);
  if (!found) return print(tl::unexpected(found.error()));
  for (const std::string& notice : found->notices) io::print_error("stickslip", "warning: " + notice);
  for (const io::UnreadFolder& folder : found->unread_folders) {
    io::print_error("stickslip", "warning: " + missing_text(folder));
  }
  const bool is_table = !options.json && !options.csv && !options.paths && !options.paths0;
  if (!is_table && !found->unread.empty()) io::print_error("stickslip", "warning: " + missing_text(*found));
  if (options.json) {
    io::print_text(stdout, io::json_document(json_of(options, *found)));
  } else if (options.csv) {
    io::print_text(stdout, csv_of(options, *found));
  } else if (options.paths || options.paths0) {
    print_paths(options, *found);
  } else {
    io::print_text(stdout, text_of(options, *found));
  }
  return io::flushed("stickslip", found->entries.empty() ? kNothingFound : 0);
}

constexpr const char* kFindHelp =
    R"(Searches the records of a folder and of all folders in it. The first search reads each record; an index is kept, and
later ones read only what is new or changed. docs/catalogue.md says where the index is.

All conditions hold; of a condition that is given several times one is enough, except --where and --fact.
In texts * is any text and ? any character. Results: S, K, S-K, static, kinetic, or as in a record
(stickslip show FILE.h5), in SI units.

Exit status:
  0  records are found
  1  the folder or the index cannot be used
  2  wrong usage
  3  no record is found

Examples:
  stickslip find records --sample "liner*" --from 2026-11-01 --to 2026-11-30
  stickslip find records --regime stick-slip --where S-K=0.04: --where S=0.3:0.4 --sort S-K
  stickslip find records --finding warning --finding fault --json
  stickslip find records --fact "humidity=45 %:55 %" --fact lot=4711
  stickslip find records --batch 20261122T180301Z -0     the files, for xargs -0 stickslip report)";

}  // namespace

void add_find(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<FindOptions>();
  CLI::App* command =
      app.add_subcommand("find", "find records by date, sample, regime, findings and results");
  command->footer(kFindHelp);
  command->add_option("folder", options->folder, "of the records; default: this one")->type_name("FOLDER");
  command->add_option("--from", options->from, "tests of this day, minute or second and later")
      ->type_name("TIME");
  command->add_option("--to", options->to, "tests up to the end of this day, minute or second")
      ->type_name("TIME");
  const auto repeated = [command](const char* name, std::vector<std::string>& into, const char* what,
                                  const char* type) {
    command->add_option(name, into, what)->type_name(type)->allow_extra_args(false);
  };
  repeated("--sample", options->samples, "name of the sample", "TEXT");
  repeated("--grade", options->grades, "grade of the paper", "TEXT");
  repeated("--operator", options->operators, "who measured", "TEXT");
  repeated("--batch", options->batches, "identifier of the batch", "TEXT");
  repeated("--method", options->methods, "test method", "TEXT");
  repeated("--fact", options->facts,
           "lot=47*, temperature=\"22 degC:24 degC\": what was stated of the test, as text or as a range",
           "KEY=VALUE");
  repeated("--regime", options->regimes, "stick-slip, ring-down, mixed, …", "REGIME");
  repeated("--finding", options->findings, "code of a finding; fault, warning, note; any; none", "CODE");
  repeated("--where", options->ranges, "range of a result; either side may be absent",
           "RESULT=LOWEST:HIGHEST");
  command
      ->add_option("--sort", options->sort,
                   "date (default), sample, grade, operator, batch, method, regime or a result")
      ->type_name("KEY");
  command->add_flag("--reverse", options->reversed, "the last first");
  command->add_option("--most", options->most, "show only the first N")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  CLI::Option* const wide = command->add_flag("--wide", options->wide, "with errors and files");
  CLI::Option* const unread =
      command->add_flag("--unread", options->unread, "name the files that could not be read, and why");
  CLI::Option* const paths = command->add_flag("--paths", options->paths, "only the files, one a line");
  CLI::Option* const paths0 = command->add_flag("-0,--paths0", options->paths0,
                                                "only the files, each followed by a zero byte (xargs -0)");
  CLI::Option* const json = command->add_flag("--json", options->json, "JSON instead of a table");
  CLI::Option* const csv =
      command->add_flag("--csv", options->csv, "CSV with all results instead of a table");
  paths->excludes(json)->excludes(csv)->excludes(wide)->excludes(paths0);
  paths0->excludes(json)->excludes(csv)->excludes(wide);
  json->excludes(csv);
  unread->excludes(json)->excludes(csv)->excludes(paths)->excludes(paths0);
  command->callback([&chosen, options] { chosen.run = [options] { return run_find(*options); }; });
}

}  // namespace stickslip::cli
