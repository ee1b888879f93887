#include "io/traces/import.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/method_option.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/subcommands.hpp"
#include "cli/transducer_options.hpp"
#include "io/findings_text.hpp"

#include "core/base/clock.hpp"
#include "core/base/text.hpp"
#include "core/base/version.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/metadata.hpp"
#include "core/record/method_text.hpp"

namespace stickslip::cli {
namespace {

using base::Dimension;
using base::Result;

/// Numbers as typed: "350 Hz", "12 in/min".
struct ImportOptions {
  std::string file;
  std::string column;
  std::string unit;
  std::string time_column;
  std::string time_unit;
  std::string rate;
  std::string speed;
  std::string sled_mass;
  std::string stiffness;
  TransducerOptions transducer;
  std::string load_cell_gain;
  std::string load_cell_zero;
  std::string count_range;
  std::string volts_per_count;
  std::string encoding;
  std::string separator;
  std::string decimal;
  std::int64_t skip = 0;
  bool inspect = false;
  bool invert = false;
  bool reverse = false;
  bool resample = false;
  bool skip_doubled = false;
  std::string sample;
  std::string grade;
  std::string person;
  std::int64_t replicate = 0;
  std::vector<std::string> metadata;  ///< "key=value"
  std::string method;                 ///< As chosen_method() takes it.
  std::string output;
};

Result<traces::DialectOptions> dialect_of(const ImportOptions& options) {
  traces::DialectOptions dialect;
  dialect.skip = options.skip;
  if (!options.encoding.empty()) {
    dialect.encoding = traces::encoding_from_name(options.encoding);
    if (!dialect.encoding) {
      return base::usage_error(
          "--encoding: \"{}\" is unknown; allowed: UTF-8, UTF-16LE, UTF-16BE, Windows-1252, Latin-1",
          base::printable(options.encoding));
    }
  }
  constexpr std::array kSeparators{std::pair{"comma", ','},
                                   std::pair{",", ','},
                                   std::pair{"semicolon", ';'},
                                   std::pair{";", ';'},
                                   std::pair{"tab", '\t'},
                                   std::pair{"bar", '|'},
                                   std::pair{"|", '|'},
                                   std::pair{"blanks", traces::kBlanks},
                                   std::pair{"none", traces::kNoSeparator}};
  for (const auto& [name, separator] : kSeparators) {
    if (options.separator == name) dialect.separator = separator;
  }
  if (!options.separator.empty() && !dialect.separator) {
    return base::usage_error(
        "--separator: \"{}\" is unknown; allowed: comma, semicolon, tab, bar, blanks, none",
        base::printable(options.separator));
  }
  if (options.decimal == "." || options.decimal == "point") dialect.decimal = '.';
  if (options.decimal == "," || options.decimal == "comma") dialect.decimal = ',';
  if (!options.decimal.empty() && !dialect.decimal) {
    return base::usage_error("--decimal: \"{}\" is unknown; allowed: point, comma",
                             base::printable(options.decimal));
  }
  return dialect;
}

Result<traces::ImportRequest> request_of(const ImportOptions& options) {
  traces::ImportRequest request;
  request.path = options.file;
  request.now_ns = base::make_system_clock()->realtime_ns();
  const auto dialect = dialect_of(options);
  if (!dialect) return tl::unexpected(dialect.error());
  request.dialect = *dialect;
  request.column = options.column;
  request.unit = options.unit;
  request.time_column = options.time_column;
  request.time_unit = options.time_unit;
  request.invert = options.invert;
  request.reverse = options.reverse;
  request.resample = options.resample;
  request.skip_doubled = options.skip_doubled;

  const auto rate_Hz = number_of("--rate", options.rate, Dimension::kFrequency, true);
  if (!rate_Hz) return tl::unexpected(rate_Hz.error());
  request.rate_Hz = *rate_Hz;
  const auto speed = number_of("--speed", options.speed, Dimension::kSpeed, true);
  if (!speed) return tl::unexpected(speed.error());
  request.tester.pull_speed_m_per_s = *speed;
  const auto mass = number_of("--sled-mass", options.sled_mass, Dimension::kMass, true);
  if (!mass) return tl::unexpected(mass.error());
  request.tester.sled_mass_kg = *mass;
  const auto stiffness = number_of("--stiffness", options.stiffness, Dimension::kStiffness, true);
  if (!stiffness) return tl::unexpected(stiffness.error());
  request.tester.stiffness_N_per_m = *stiffness;
  const auto transducer = stated_transducer(options.transducer);
  if (!transducer) return tl::unexpected(transducer.error());
  request.tester.set_transducer(*transducer);
  const auto gain = number_of("--load-cell-gain", options.load_cell_gain, Dimension::kForcePerVoltage, false);
  if (!gain) return tl::unexpected(gain.error());
  const auto zero = number_of("--load-cell-zero", options.load_cell_zero, Dimension::kVoltage, false);
  if (!zero) return tl::unexpected(zero.error());
  if (*gain && **gain != 0.0) request.load_cell = daq::LoadCell{**gain, zero->value_or(0.0)};
  if ((*gain && **gain == 0.0) || (*zero && !*gain)) {
    return base::usage_error("--load-cell-zero needs --load-cell-gain, not 0, such as \"2 N/V\"");
  }

  const auto step = number_of("--volts-per-count", options.volts_per_count, Dimension::kVoltage, true);
  if (!step) return tl::unexpected(step.error());
  if (options.count_range.empty() != options.volts_per_count.empty()) {
    return base::usage_error("{0} needs {1}: give --count-range, such as 0..65535, and --volts-per-count",
                             options.count_range.empty() ? "--volts-per-count" : "--count-range",
                             options.count_range.empty() ? "--count-range" : "--volts-per-count");
  }
  if (*step) {
    const auto counts = traces::count_scale(options.count_range, **step);
    if (!counts) return tl::unexpected(counts.error());
    request.counts = *counts;
  }

  for (const auto& [name, text] :
       {std::pair{"--sample", &options.sample}, std::pair{"--grade", &options.grade},
        std::pair{"--operator", &options.person}}) {
    if (const std::string refusal = base::name_refusal(*text); !refusal.empty()) {
      return base::usage_error("{}: {}", name, refusal);
    }
  }
  request.sample.name = options.sample;
  request.sample.grade = options.grade;
  request.sample.operator_name = options.person;
  if (options.replicate > 0) request.sample.replicate = options.replicate;
  for (const std::string& pair : options.metadata) {
    if (const auto added = record::add_metadata(request.sample.metadata, pair, "--set-meta"); !added)
      return tl::unexpected(added.error());
  }
  request.process.program = "stickslip import";
  request.process.version = base::kVersion;
  request.process.commit = base::kCommit;
  const Result<model::Method> method = chosen_method(options.method);
  if (!method) return tl::unexpected(method.error());
  request.process.method = record::method_text(*method);
  return request;
}

/// "x.h5", or "x-2.h5" where there are several.
std::string output_of(const std::string& output, std::size_t number, std::size_t count) {
  if (count == 1) return output;
  const std::filesystem::path path{output};
  return (path.parent_path() /
          fmt::format("{}-{}{}", path.stem().string(), number, path.extension().string()))
      .string();
}

/// Throws std::system_error if the folder of the output cannot hold the scans for the time being.
Result<std::string> make_records(const ImportOptions& options, const std::string& command_line) {
  Result<traces::ImportRequest> request = request_of(options);
  if (!request) return tl::unexpected(request.error());
  if (options.inspect) return traces::inspect(*request);
  const auto no_output = [] {
    return base::usage_error("--output is needed: the record to make, such as -o pull.h5");
  };
  if (!options.column.empty() && options.output.empty()) return no_output();
  // An exported record keeps its method unless another one is asked for.
  if (options.column.empty() && options.method.empty()) request->process.method.clear();
  const std::filesystem::path output_path{options.output};
  if (!options.output.empty()) {
    request->scratch_folder = output_path.has_parent_path() ? output_path.parent_path() : ".";
    if (std::error_code ignored; !std::filesystem::is_directory(request->scratch_folder, ignored)) {
      if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());
    }
  }
  ProgressBar bar{base::printable(std::filesystem::path{options.file}.filename().string())};
  request->progress = [&bar](double done) { bar.show(done); };
  Result<traces::Imported> imported = traces::import_trace(*request);
  if (!imported) return tl::unexpected(imported.error());
  if (options.output.empty()) return no_output();
  std::string text = std::move(imported->report);
  for (const auto& [key, value] : request->sample.metadata) {
    if (const std::string why = record::why_no_number(key, value); !why.empty())
      text += fmt::format("{}; kept as text, without a number\n", base::printable(why));
  }
  std::vector<traces::ImportedTest>& tests = imported->tests;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (auto free = record::check_publishable(output_of(options.output, i + 1, tests.size())); !free)
      return tl::unexpected(free.error());
  }
  bar.show("analysing");
  const auto end_of = [&](const record::Record& record,
                          const record::ScanSource& scans) -> Result<record::EndRecord> {
    Result<record::EndRecord> end = evaluation::analyse(record, scans, request->scratch_folder);
    if (!end) return end;
    for (const base::Finding& finding : record.end->results.findings)
      base::add(end->results.findings, finding);
    if (imported->is_own) end->spikes = record.spikes;
    return end;
  };
  for (traces::ImportedTest& test : tests) {
    test.record.header.process.source_command = command_line;
    if (tests.size() == 1) break;  // It is analysed while its scans are written.
    Result<record::EndRecord> end = end_of(test.record, test.scans);
    if (!end) return tl::unexpected(end.error());
    record::set_end(test.record, std::move(*end));
  }
  if (tests.size() > 1) bar.show("writing");
  for (std::size_t i = 0; i < tests.size(); ++i) {
    record::Record& record = tests[i].record;
    const record::ColumnScans& scans = tests[i].scans;
    const std::string output = output_of(options.output, i + 1, tests.size());
    const Result<void> published =
        tests.size() > 1 ? record::publish_record(record, scans, output)
                         : record::publish_record(record, scans, output,
                                                  [&, own = scans.view()] { return end_of(record, own); });
    if (!published) return tl::unexpected(published.error());
    text += fmt::format("{}: {} scans", base::printable(output), tests[i].scans.size());
    std::int64_t missing = 0;
    for (const daq::Gap& gap : record.gaps) missing += gap.count;
    if (missing > 0)
      text += fmt::format(", {} missing in {} gap{}", missing, record.gaps.size(),
                          record.gaps.size() == 1 ? "" : "s");
    text += "\n";
    for (const base::Finding& finding : record.end->results.findings)
      text += io::finding_text(finding, "  finding: ");
  }
  return text;
}

Result<std::string> run_import(const ImportOptions& options, const std::string& command_line) {
  try {
    return make_records(options, command_line);
  } catch (const std::system_error& error) {
    return base::failure("{}", error.what());
  }
}

constexpr const char* kImportExamples =
    R"(Examples:
  stickslip import pull.csv --inspect                          its columns, and the command that imports them
  stickslip import pull.csv --column force --rate "350 Hz" --unit N --sled-mass "2331 g" -o pull.h5
  stickslip import trace.csv --column mu --rate "2 kHz" --unit coefficient --speed "12 in/min" -o trace.h5)";

}  // namespace

void add_import(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      app.add_subcommand("import", "make records from a measured trace in a file of another program");
  command->footer(kImportExamples);
  const auto text = [command](const char* name, std::string& value, const char* what, const char* type) {
    return command->add_option(name, value, what)->type_name(type);
  };
  text("file", options->file, "table of numbers: text as another program exported it, .mat of MATLAB, HDF5",
       "FILE.csv")
      ->required();
  text("--column,--dataset", options->column,
       "heading or number of the column with the values; variable of MATLAB, dataset of HDF5; none for a "
       "table "
       "of stickslip export",
       "NAME");
  text("-o,--output", options->output,
       "record to make, must not exist; x.h5 becomes x-1.h5, x-2.h5 … where the trace has several tests",
       "FILE.h5");
  command->add_flag("--inspect", options->inspect,
                    "show the columns and a command that imports them; import nothing");
  text("--unit", options->unit,
       "unit of the values: N, mN, kN, gf, kgf, lbf, ozf, V, mV, counts, coefficient, percent; else that of "
       "the "
       "heading",
       "UNIT");
  text("--sled-mass", options->sled_mass, "with unit: \"200 g\"; needed for a force or a voltage", "M");
  text("--rate", options->rate,
       "scan rate, with unit: \"350 Hz\"; else the time column tells it, which is checked against it", "HZ");
  text("--time-column,--time-dataset", options->time_column,
       "heading or number of the time; else by its name; none: do not read it", "NAME");
  text("--time-unit", options->time_unit,
       "s, ms, us, ns, min or h; else that of the heading, else by inspection", "UNIT");
  text("--speed", options->speed, "pull speed, with unit: \"12 in/min\"", "V");
  text("--stiffness", options->stiffness, "of the coupling, with unit: \"920 N/m\"", "K");
  add_transducer_options(*command, options->transducer);
  text("--load-cell-gain", options->load_cell_gain, "with unit: \"2 N/V\"; needed for V and counts", "GAIN");
  text("--load-cell-zero", options->load_cell_zero, "with unit: \"12 mV\"; for V and counts, default 0 V",
       "ZERO");
  text("--count-range", options->count_range, "codes at both rails of the converter; for counts",
       "LOWEST..HIGHEST");
  text("--volts-per-count", options->volts_per_count, "with unit: \"0.31 mV\", 0 V at code 0; for counts",
       "VOLTS");
  command->add_flag("--invert", options->invert, "the force is negative while the sled slides");
  command->add_flag("--reverse", options->reverse, "read the rows from the last to the first");
  command->add_flag("--resample", options->resample,
                    "unequal intervals: interpolate the scans at equal ones");
  command->add_flag("--skip-doubled", options->skip_doubled,
                    "leave out rows with the time of the row before");
  text("--encoding", options->encoding, "UTF-8, UTF-16LE, UTF-16BE, Windows-1252, Latin-1; else recognised",
       "NAME");
  text("--separator", options->separator, "comma, semicolon, tab, bar, blanks or none; else recognised",
       "WORD");
  text("--decimal", options->decimal, "point or comma; else recognised", "WORD");
  command->add_option("--skip", options->skip, "lines at the beginning that are no part of the table")
      ->type_name("LINES")
      ->check(CLI::NonNegativeNumber);
  text("--sample", options->sample, "name of the sample", "TEXT");
  text("--grade", options->grade, "grade of the sample", "TEXT");
  text("--operator", options->person, "who measured", "TEXT");
  command->add_option("--replicate", options->replicate, "number of the replicate, from 1")
      ->type_name("COUNT")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--set-meta", options->metadata,
                   "a fact of your own, such as \"humidity=52 %\"; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_method_option(*command, options->method);
  choose(*command, chosen, [options, &chosen] { return run_import(*options, chosen.line); });
}

}  // namespace stickslip::cli
