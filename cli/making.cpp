// Subcommands that make records: import, simulate, sweep.

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
namespace {

void add_import(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ImportCommand>();
  ImportCommand& command = *kept;
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
  add_method_option(*import, command.method);
  import->add_option("--speed", command.speed, "pull speed, m/s or with unit")->type_name("V");
  import->add_option("--sled-mass", command.sled_mass, "kg or with unit; needed for N and V")->type_name("M");
  import->add_option("--stiffness", command.stiffness, "of the coupling, N/m or with unit")->type_name("K");
  import->add_option("--load-cell-gain", command.load_cell_gain, "N/V or with unit; needed for V")
      ->type_name("GAIN");
  import->add_option("--load-cell-zero", command.load_cell_zero, "V or with unit; for V, default 0 V")
      ->type_name("ZERO");
  choose(*import, chosen, [kept] { return run_import(*kept); });
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

void add_simulate(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<SimulateCommand>();
  SimulateCommand& command = *kept;
  command.line = chosen.line;
  CLI::App* simulate = app.add_subcommand("simulate", "run a scene straight into a record, with its truth");
  simulate->footer(kSimulateExamples);
  add_scene_options(*simulate, command);
  simulate->add_option("-o,--output", command.output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  add_method_option(*simulate, command.method);
  simulate->add_flag("--json", command.json, "JSON instead of a table; SI units, names as in the record");
  choose(*simulate, chosen, [kept] { return run_simulate(*kept); });
}

constexpr const char* kSweepExamples =
    R"(Runs a scene at every point of a grid, several times each with other random numbers, and keeps the results and
the truth of each run in one file. The file is the same, byte for byte, for any number of threads.
Changes apply in this order: --without, --set, --rate, --vary, --duration.

Ctrl-C (or SIGTERM) finishes the runs begun, keeps all in FILE.h5.part and ends with exit status 130; a second
Ctrl-C ends at once. The same command goes on from there.

KEY=FROM:TO:N        N values evenly from FROM to TO, with units as in scene files
KEY=log:FROM:TO:N    the same, evenly in their logarithms
KEY=A,B,C            these values

Examples:
  stickslip sweep threshold-oscillation --vary paper.mu_s=0.31:0.35:9 --repeat 20 -o threshold.h5
  stickslip sweep stick-slip-at-12-in-per-min -o map.h5 --repeat 10 \
    --vary "effects.constant_speed.pull_speed=3 in/min:30 in/min:10" --vary paper.mu_s=0.31:0.36:6
  stickslip sweep scattered-paper --repeat 1000 --duration 10 -o scatter.h5 --json)";

void add_sweep(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<SweepCommand>();
  SweepCommand& command = *kept;
  CLI::App* sweep = app.add_subcommand("sweep", "run a scene over a grid of its keys, on all processors");
  sweep->footer(kSweepExamples);
  add_scene_options(*sweep, command);
  sweep->add_option("-o,--output", command.output, "file to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  sweep->add_option("--vary", command.vary, "key of the scene with its values; several make a grid")
      ->allow_extra_args(false)
      ->type_name("KEY=FROM:TO:N");
  sweep->add_option("--repeat", command.repeat, "runs at each point; 1 unless given")->type_name("N");
  sweep->add_option("--threads", command.threads, "else one for each processor")->type_name("N");
  sweep->add_flag("--json", command.json, "JSON instead of a table");
  choose(*sweep, chosen, [kept] { return run_sweep(*kept); });
}

}  // namespace

void add_making_commands(CLI::App& app, Chosen& chosen) {
  add_import(app, chosen);
  add_simulate(app, chosen);
  add_sweep(app, chosen);
}

}  // namespace stickslip::cli
