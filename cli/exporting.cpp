// Subcommand that gives tables away: export.

#include <fmt/format.h>

#include "cli/subcommands.hpp"
#include "io/export_csv.hpp"
#include "io/new_file.hpp"

#include "core/base/text.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::cli {
namespace {

struct ExportCommand {
  std::string file;
  std::string output;  ///< Empty: stdout.
  bool csv = false;
  bool cycles = false;
};

base::Result<std::string> run_export(const ExportCommand& command) {
  if (!command.csv) return base::usage_error("export: --csv says as what; there is no other yet");
  if (!command.output.empty()) {
    if (auto free = record::check_publishable(command.output); !free) return tl::unexpected(free.error());
  }
  const base::Result<record::Record> record = record::read_record_apart(command.file);
  if (!record) return tl::unexpected(record.error());
  std::string text = command.cycles ? io::cycles_csv(*record) : io::scans_csv(*record);
  if (command.output.empty()) return text;
  if (auto written = io::write_new_file(command.output, text); !written)
    return tl::unexpected(written.error());
  return fmt::format("{}: {} rows\n", base::printable(command.output),
                     command.cycles ? record->cycles.size() : record->scan.size());
}

constexpr const char* kExportExamples =
    R"(Scans (or cycles) of a record as a table for spreadsheets. Lines that begin with # tell the facts; names end in
their units; numbers have all their digits, so that `stickslip import` gives them back to the last one.

Examples:
  stickslip export pull.h5 --csv > pull.csv
  stickslip export pull.h5 --csv --cycles -o cycles.csv)";

}  // namespace

void add_exporting_commands(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ExportCommand>();
  ExportCommand& command = *kept;
  CLI::App* exporting = app.add_subcommand("export", "scans or cycles of a record as a table of text");
  exporting->footer(kExportExamples);
  exporting->add_option("file", command.file, "record")->required()->type_name("FILE.h5");
  exporting->add_flag("--csv", command.csv, "as comma-separated values");
  exporting->add_flag("--cycles", command.cycles, "the cycles instead of the scans");
  exporting->add_option("-o,--output", command.output, "file to make, must not exist; else stdout")
      ->type_name("FILE.csv");
  choose(*exporting, chosen, [kept] { return run_export(*kept); });
}

}  // namespace stickslip::cli
