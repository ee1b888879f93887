// stickslip: the command line. Exit status 0 done, 1 the world did not allow it, 2 usage or input.

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/cli/commands.hpp"
#include "daemon/version.hpp"

namespace stickslip::daemon {
namespace {

constexpr const char* kExamples = R"(Examples:
  stickslip import pull.csv --column force --rate 350 --unit N --sled-mass "2331 g" -o pull.h5
  stickslip import trace.csv --column mu --rate "2 kHz" --unit coefficient --speed "12 in/min" -o trace.h5
  stickslip scenes                                     the shipped scenes, one line each
  stickslip simulate stick-slip-at-12-in-per-min -o pull.h5 --seed 7
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

constexpr const char* kSimulateExamples =
    R"(Runs one repetition of a scene straight into a record: the same counts, analysis and truth as from the
daemon that plays it, but the record is the whole scene; the daemon would cut out the test.
Changes apply in this order: --without, --set, --rate, --duration.

Examples:
  stickslip simulate stick-slip-at-12-in-per-min -o pull.h5
  stickslip simulate my-scene.toml -o pull.h5 --seed 7 --json
  stickslip simulate threshold-oscillation -o above.h5 --set paper.mu_s=0.34 --set effects.white_noise.sd=0.002
  stickslip simulate stick-slip-at-12-in-per-min -o hour.h5 --duration 3600
  stickslip simulate stick-slip-at-12-in-per-min -o fast.h5 --rate "2 kHz" --without white_noise
  stickslip simulate ring-down-at-12-in-per-min -o slow.h5 --set "effects.constant_speed.pull_speed=6 in/min")";

void add_simulate(CLI::App& app, SimulateCommand& command) {
  CLI::App* simulate = app.add_subcommand("simulate", "run a scene straight into a record, with its truth");
  simulate->footer(kSimulateExamples);
  simulate->add_option("scene", command.scene, "file, or name as in stickslip scenes")
      ->required()
      ->type_name("SCENE");
  simulate->add_option("-o,--output", command.output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  simulate->add_option("--seed", command.seed, "of the random numbers; else that of the scene")
      ->type_name("N");
  simulate->add_option("--set", command.set, "change a key of the scene; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  simulate->add_option("--without", command.without, "drop a listed effect; may be repeated")
      ->allow_extra_args(false)
      ->type_name("EFFECT");
  simulate
      ->add_option("--duration", command.duration, "of the whole scene, s or with unit: the pull is fitted")
      ->type_name("T");
  simulate->add_option("--rate", command.rate, "scans per second; else that of the scene")->type_name("HZ");
  simulate->add_option("--folder", command.folder, "of the scenes that have names")->type_name("DIR");
  simulate->add_flag("--json", command.json, "JSON instead of a table; SI units, names as in the record");
}

/// The command as a shell would take it again.
std::string command_line(int count, char** arguments) {
  std::string line = "stickslip";
  for (int i = 1; i < count; ++i) {
    const std::string_view argument = arguments[i];
    const bool plain =
        !argument.empty() && argument.find_first_of(" \t\n\"'\\$`*?[](){}<>|&;#~!") == argument.npos;
    line += ' ';
    if (plain) {
      line += argument;
      continue;
    }
    line += '\'';
    for (const char c : argument) line += c == '\'' ? std::string{"'\\''"} : std::string{c};
    line += '\'';
  }
  return line;
}

int main_of(int count, char** arguments) {
  CLI::App app{"stickslip: friction tests from the command line"};
  app.footer(kExamples);
  app.set_version_flag("--version", fmt::format("stickslip {} ({})", kVersion, kCommit));
  app.require_subcommand(1);

  ImportCommand import;
  add_import(app, import);

  SimulateCommand simulation;
  add_simulate(app, simulation);

  std::string folder;
  bool scenes_json = false;
  CLI::App* scenes = app.add_subcommand("scenes", "list the shipped scenes");
  scenes->add_option("--folder", folder, "another folder of scenes")->type_name("DIR");
  scenes->add_flag("--json", scenes_json, "JSON instead of lines");

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
  if (scenes->parsed()) return print(run_scenes(folder, scenes_json));
  if (app.got_subcommand("simulate")) {
    simulation.line = command_line(count, arguments);
    return print(run_simulate(simulation));
  }
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
