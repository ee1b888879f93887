// stickslip: the command line. Exit status 0 done, 1 the world did not allow it, 2 usage or input.

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/cli/commands.hpp"
#include "daemon/version.hpp"

namespace stickslip::daemon {
namespace {

constexpr const char* kExamples = R"(Examples:
  stickslip import pull.csv --column force --rate 350 --unit N --sled-mass "2331 g" -o pull.h5
  stickslip import trace.csv --column mu --rate "2 kHz" --unit coefficient --speed "12 in/min" -o trace.h5
  stickslip analyze records/*.h5                       a table, with the truth where it is known
  stickslip analyze trace.h5 --json                    {"tests": [{"file": …, results …, "details": …}]}
  stickslip status                                     what the daemon is doing)";

int print(const base::Result<std::string>& output) {
  if (!output) {
    fmt::print(stderr, "stickslip: {}\n", output.error().message);
    return output.error().exit_status();
  }
  fmt::print("{}", *output);
  return std::fflush(stdout) == 0 ? 0 : 1;
}

void add_import(CLI::App& app, ImportCommand& command) {
  CLI::App* import = app.add_subcommand("import", "make a record from a measured trace in a CSV file");
  import->add_option("csv", command.csv, "file with a header line")->required()->type_name("FILE.csv");
  import->add_option("--column", command.column, "header of the column with the values")
      ->required()
      ->type_name("NAME");
  import->add_option("--rate", command.rate, "scans per second; a time column is checked against it")
      ->required()
      ->type_name("HZ");
  import->add_option("--unit", command.unit, "of the values: coefficient, N or V")
      ->required()
      ->type_name("UNIT");
  import->add_option("-o,--output", command.output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  import
      ->add_option("--time-column", command.time_column,
                   "header of the time in s (else t, t_s, time, time_s)")
      ->type_name("NAME");
  import->add_option("--speed", command.speed, "pull speed, m/s or with unit")->type_name("V");
  import->add_option("--sled-mass", command.sled_mass, "kg or with unit; needed for N and V")->type_name("M");
  import->add_option("--stiffness", command.stiffness, "of the coupling, N/m or with unit")->type_name("K");
  import->add_option("--load-cell-gain", command.load_cell_gain, "N/V or with unit; needed for V")
      ->type_name("GAIN");
  import->add_option("--load-cell-zero", command.load_cell_zero, "V or with unit; for V, default 0 V")
      ->type_name("ZERO");
}

int main_of(int count, char** arguments) {
  CLI::App app{"stickslip: friction tests from the command line"};
  app.footer(kExamples);
  app.set_version_flag("--version", fmt::format("stickslip {} ({})", kVersion, kCommit));
  app.require_subcommand(1);

  ImportCommand import;
  add_import(app, import);

  std::vector<std::string> files;
  bool json = false;
  CLI::App* analyze = app.add_subcommand("analyze", "run the detector and the estimators over records");
  analyze->add_option("files", files, "records")->required()->type_name("FILE.h5");
  analyze->add_flag("--json", json, "JSON instead of a table; names as in the record, null where absent");

  std::string socket = "/run/stickslip/control.sock";
  CLI::App* status = app.add_subcommand("status", "ask the running daemon");
  status->add_option("--socket", socket, "its control socket")->capture_default_str()->type_name("PATH");

  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    fmt::print(stderr, "stickslip: {}; see stickslip --help\n", error.what());
    return 2;
  }
  if (analyze->parsed()) return print(run_analyze(files, json));
  if (status->parsed()) return print(run_status(socket));
  return print(run_import(import));
}

}  // namespace
}  // namespace stickslip::daemon

int main(int count, char** arguments) {
  try {
    return stickslip::daemon::main_of(count, arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "stickslip: {}\n", error.what());
    return 1;
  }
}
