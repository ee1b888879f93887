#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/subcommands.hpp"
#include "io/export_csv.hpp"
#include "io/new_file.hpp"

#include "core/base/text.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/read_apart.hpp"

namespace stickslip::cli {
namespace {

struct ExportOptions {
  std::string file;
  std::string output;  ///< Empty: stdout.
  bool csv = false;
  bool cycles = false;
};

base::Result<std::string> run_export(const ExportOptions& options) {
  if (!options.csv) return base::usage_error("export: add --csv, the only format there is");
  if (!options.output.empty()) {
    if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());
  }
  const base::Result<record::Record> record = record::read_record_apart(options.file);
  if (!record) return tl::unexpected(record.error());
  std::string text = options.cycles ? io::cycles_csv(*record) : io::scans_csv(*record);
  if (options.output.empty()) return text;
  if (auto written = io::write_new_file(options.output, text); !written)
    return tl::unexpected(written.error());
  return fmt::format("{}: {} rows\n", base::printable(options.output),
                     options.cycles ? record->cycles.size() : record->scan.size());
}

constexpr const char* kExportExamples =
    R"(Scans (or cycles) of a record as a table for spreadsheets. Lines that begin with # tell the facts; names end in
their units; numbers have all their digits, so that `stickslip import` makes the same record of it again.

Examples:
  stickslip export pull.h5 --csv > pull.csv
  stickslip import pull.csv -o again.h5
  stickslip export pull.h5 --csv --cycles -o cycles.csv)";

}  // namespace

void add_export(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "write scans or cycles of a record as a table of text");
  command->footer(kExportExamples);
  command->add_option("file", options->file, "record")->required()->type_name("FILE.h5");
  command->add_flag("--csv", options->csv, "as comma-separated values");
  command->add_flag("--cycles", options->cycles, "the cycles instead of the scans");
  command->add_option("-o,--output", options->output, "file to make, must not exist; else stdout")
      ->type_name("FILE.csv");
  choose(*command, chosen, [options] { return run_export(*options); });
}

}  // namespace stickslip::cli
