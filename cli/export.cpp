#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/options.hpp"
#include "cli/subcommands.hpp"
#include "io/export_csv.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include "report/binned_trace.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::cli {
namespace {

struct ExportOptions {
  std::string file;
  std::string output;  ///< Empty: stdout.
  std::string from;
  std::string to;
  std::size_t points = report::kUsualBins;
  bool csv = false;
  bool json = false;
  bool cycles = false;
};

/// Most bins of a trace: more would make over 64 MiB of JSON.
constexpr std::size_t kMostPoints = 1'000'000;

base::Result<std::string> trace_text(const record::Record& record, const ExportOptions& options) {
  report::TraceSpan span{.bins = options.points};
  const auto time_of = [](const char* option, const std::string& text) {
    return number_of(option, text, base::Dimension::kTime, false, base::BareNumber::kSi);
  };
  const auto from = time_of("--from", options.from);
  if (!from) return tl::unexpected(from.error());
  const auto to = time_of("--to", options.to);
  if (!to) return tl::unexpected(to.error());
  span.from_s = *from;
  span.to_s = *to;
  const base::Result<nlohmann::ordered_json> trace = report::binned_trace_json(record, span);
  if (!trace)
    return tl::unexpected(base::Error{
        trace.error().kind, fmt::format("{}: {}", base::printable(options.file), trace.error().message)});
  return io::json_text(*trace) + "\n";
}

base::Result<std::string> run_export(const ExportOptions& options) {
  if (!options.csv && !options.json)
    return base::usage_error("export: add --csv, a table of all scans, or --json, the trace to draw");
  if (!options.output.empty()) {
    if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());
  }
  const base::Result<record::Record> record = record::read_record_apart(options.file);
  if (!record) return tl::unexpected(record.error());
  std::string text;
  if (options.json) {
    base::Result<std::string> trace = trace_text(*record, options);
    if (!trace) return trace;
    text = *std::move(trace);
  } else {
    text = options.cycles ? io::cycles_csv(*record) : io::scans_csv(*record);
  }
  if (options.output.empty()) return text;
  if (auto written = io::write_new_file(options.output, text); !written)
    return tl::unexpected(written.error());
  if (options.json)
    return fmt::format("{}: {} scans\n", base::printable(options.output), record->scan.size());
  return fmt::format("{}: {} rows\n", base::printable(options.output),
                     options.cycles ? record->cycles.size() : record->scan.size());
}

constexpr const char* kExportExamples =
    R"(Scans (or cycles) of a record as a table for spreadsheets. Lines that begin with # tell the facts; names end in
their units; numbers have all their digits, so that `stickslip import` makes the same record of it again.
--json is the force over weight to draw: lowest and highest of at most --points equal bins of a span, its cycles, S and K,
as GET /v1/tests/N/trace of the daemon answers.

Examples:
  stickslip export pull.h5 --csv > pull.csv
  stickslip import pull.csv -o again.h5
  stickslip export pull.h5 --csv --cycles -o cycles.csv
  stickslip export pull.h5 --json --points 800 --from "1.2 s" --to "1.5 s")";

}  // namespace

void add_export(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "write scans or cycles of a record as a table of text");
  command->footer(kExportExamples);
  command->add_option("file", options->file, "record")->required()->type_name("FILE.h5");
  CLI::Option* const csv = command->add_flag("--csv", options->csv, "as comma-separated values");
  CLI::Option* const json =
      command->add_flag("--json", options->json, "the trace with its cycles, to draw, as JSON")
          ->excludes(csv);
  command->add_flag("--cycles", options->cycles, "the cycles instead of the scans")->excludes(json);
  command->add_option("--points", options->points, "with --json: most bins")
      ->check(CLI::Range(std::size_t{1}, kMostPoints))
      ->type_name("COUNT")
      ->needs(json);
  command
      ->add_option("--from", options->from,
                   "with --json: start of the span, s or with unit, after the first scan")
      ->type_name("T")
      ->needs(json);
  command->add_option("--to", options->to, "with --json: end of the span")->type_name("T")->needs(json);
  command->add_option("-o,--output", options->output, "file to make, must not exist; else stdout")
      ->type_name("FILE.csv");
  choose(*command, chosen, [options] { return run_export(*options); });
}

}  // namespace stickslip::cli
