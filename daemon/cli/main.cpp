// stickslip: the command line. Exit status 0 done, 1 the world did not allow it, 2 usage or input, 130
// interrupted.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/cli/commands.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/version.hpp"

namespace stickslip::daemon {
namespace {

constexpr const char* kOtherMaterial = "--against";

constexpr const char* kExamples = R"(Examples:
  stickslip import pull.csv --column force --rate 350 --unit N --sled-mass "2331 g" -o pull.h5
  stickslip import trace.csv --column mu --rate "2 kHz" --unit coefficient --speed "12 in/min" -o trace.h5
  stickslip scenes                                     the shipped scenes, one line each
  stickslip simulate stick-slip-at-12-in-per-min -o pull.h5 --seed 7
  stickslip sweep ring-down-at-12-in-per-min --vary paper.mu_s=0.31:0.35:5 --repeat 20 -o sweep.h5
  stickslip plot pull.h5 --from 1 --to 2               pull.svg: force, modes, peaks
  stickslip accuracy threshold-oscillation -o a.html   error against time, for each way to solve it
  stickslip analyze records/*.h5                       a table, with the truth where it is known
  stickslip analyze trace.h5 --method iso-8295         stickslip methods lists the shipped ones
  stickslip analyze trace.h5 --estimator peak          S and K as the tradition has them, for comparison
  stickslip analyze trace.h5 --json                    {"tests": [{"file": …, results …, "details": …}]}
  stickslip characterise ring-down.h5 -o tester.toml   omega and gamma of the tester, for --tester
  stickslip report records/*.h5 -o report.html         replicates, coefficient against speed, traces
  stickslip compare a*.h5 -- b*.h5                     do two materials differ, and how many tests would show it
  stickslip boards                                     A/D boards, what they offer, what to configure
  stickslip status                                     what the daemon is doing)";

int print(const base::Result<std::string>& output) {
  if (!output) {
    fmt::print(stderr, "stickslip: {}\n", output.error().message);
    return output.error().exit_status();
  }
  fmt::print("{}", *output);
  return std::fflush(stdout) == 0 ? 0 : 1;
}

void add_method_option(CLI::App& command, std::string& method) {
  command
      .add_option("--method", method,
                  "test method by which the traditional coefficients are read: file.toml, or name as in "
                  "stickslip methods")
      ->type_name("METHOD");
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
  add_method_option(*import, command.method);
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

/// Scene and changes.
void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("scene", options.scene, "file, or name as in stickslip scenes")
      ->required()
      ->type_name("SCENE");
  command.add_option("--seed", options.seed, "of the random numbers; else that of the scene")->type_name("N");
  command.add_option("--set", options.set, "change a key of the scene; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--without", options.without, "drop a listed effect; may be repeated")
      ->allow_extra_args(false)
      ->type_name("EFFECT");
  command
      .add_option("--duration", options.duration, "of the whole scene, s or with unit: the pull is fitted")
      ->type_name("T");
  command.add_option("--rate", options.rate, "scans per second; else that of the scene")->type_name("HZ");
  command.add_option("--folder", options.folder, "of the scenes that have names")->type_name("DIR");
}

void add_simulate(CLI::App& app, SimulateCommand& command) {
  CLI::App* simulate = app.add_subcommand("simulate", "run a scene straight into a record, with its truth");
  simulate->footer(kSimulateExamples);
  add_scene_options(*simulate, command);
  simulate->add_option("-o,--output", command.output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  add_method_option(*simulate, command.method);
  simulate->add_flag("--json", command.json, "JSON instead of a table; SI units, names as in the record");
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

void add_sweep(CLI::App& app, SweepCommand& command) {
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
}

constexpr const char* kPlotExamples =
    R"(Draws the force over time, as SVG. Shaded: the modes that the truth knows (stick, slip, slack). Dashed: S and K
of each slip in the truth. Points: the peaks that the detector found. A scene is simulated first, with its own
seed. Needs gnuplot (Debian package gnuplot-nox).

Examples:
  stickslip plot records/test-3.h5                     test-3.svg, the whole record
  stickslip plot pull.h5 -o onset.svg --from 0.9 --to "1.4 s"
  stickslip plot stick-slip-at-12-in-per-min -o fig3.svg --from 2 --to 3 --overview
  stickslip plot my-scene.toml -o speed.svg --from 2 --to 2.5 --derivative)";

void add_plot(CLI::App& app, PlotCommand& command) {
  CLI::App* plot = app.add_subcommand("plot", "draw a record or a scene");
  plot->footer(kPlotExamples);
  plot->add_option("input", command.input, "record; or scene: file.toml, or name as in stickslip scenes")
      ->required()
      ->type_name("FILE.h5|SCENE");
  plot->add_option("-o,--output", command.output,
                   "picture to make; must not exist; else the input's name with .svg, here")
      ->type_name("FILE.svg");
  plot->add_option("--from", command.from, "start of the part to show, s or with unit, after the first scan")
      ->type_name("T");
  plot->add_option("--to", command.to, "end of the part to show")->type_name("T");
  plot->add_flag("--overview", command.overview, "the whole record above, with the part marked");
  plot->add_flag("--derivative", command.derivative, "the speed at which the coupling stretches below");
  plot->add_option("--folder", command.folder, "of the scenes that have names")->type_name("DIR");
}

constexpr const char* kAccuracyExamples =
    R"(Computes the motion of a scene by every method there is, each at several settings, and compares with closed
forms in 50 digits (CVODE at its tightest for friction that has none): largest error of the coefficient, time
per simulated scan, and whether the capture near the threshold is found. Then the same for the estimators of
S - K. Changes apply in this order: --without, --set, --rate, --duration.

Examples:
  stickslip accuracy stick-slip-at-12-in-per-min
  stickslip accuracy threshold-oscillation -o accuracy.html
  stickslip accuracy my-scene.toml -o accuracy.svg --set paper.mu_s=0.34 --duration 20
  stickslip accuracy ring-down-at-12-in-per-min --json)";

void add_accuracy(CLI::App& app, AccuracyCommand& command) {
  CLI::App* accuracy = app.add_subcommand("accuracy", "measure what accuracy costs in time, for one scene");
  accuracy->footer(kAccuracyExamples);
  add_scene_options(*accuracy, command);
  accuracy->add_option("-o,--output", command.output, "picture or page to make; must not exist")
      ->type_name("FILE.svg|FILE.html");
  accuracy->add_flag("--json", command.json, "JSON instead of a table");
}

constexpr const char* kReportExamples =
    R"(Shows the results that stand in records of one material: coefficient against speed (Fig. 1 of the paper), mean,
scatter s_r, repeatability r = 2.8 s_r, 95 % confidence interval, outliers (named, never left out).

Examples:
  stickslip report records/*.h5
  stickslip report pull.h5 -o pull.html                one page with traces to zoom in; needs no network
  stickslip report records/*.h5 --json --csv tests.csv)";

constexpr const char* kCompareExamples =
    R"(Compares two materials at each speed: difference with 95 % interval, Welch's t test, effect size (Hedges' g), and how
many tests of each would have found a difference as large with 80 % and 90 % probability.

Examples:
  stickslip compare thorold/*.h5 -- baie-comeau/*.h5 --label-a Thorold --label-b "Baie Comeau"
  stickslip compare a*.h5 -- b*.h5 -o comparison.html
  stickslip compare a*.h5 -- b*.h5 --json --csv comparison.csv)";

void add_report_options(CLI::App& command, ReportOptions& options) {
  command
      .add_option("-o,--output", options.page,
                  "page to make, one file with traces to zoom in; must not exist")
      ->type_name("FILE.html");
  command.add_option("--csv", options.csv, "table to make; must not exist")->type_name("FILE.csv");
  command.add_flag("--json", options.json, "JSON instead of tables; SI units, null where there is no number");
}

void add_report(CLI::App& app, ReportCommand& command) {
  CLI::App* report =
      app.add_subcommand("report", "replicates: means, repeatability, coefficient against speed");
  report->footer(kReportExamples);
  report->add_option("files", command.files, "records")->required()->type_name("FILE.h5");
  add_report_options(*report, command);
}

void add_compare(CLI::App& app, CompareCommand& command) {
  CLI::App* compare = app.add_subcommand("compare", "two materials: stickslip compare A… -- B…");
  compare->footer(kCompareExamples);
  compare->add_option("a", command.a, "records of the one")->type_name("A.h5");
  compare->add_option(kOtherMaterial, command.b, "records of the other; a plain -- does the same")
      ->type_name("B.h5");
  compare->add_option("--label-a", command.label_a, "what the one is called")->type_name("NAME");
  compare->add_option("--label-b", command.label_b, "what the other is called")->type_name("NAME");
  add_report_options(*compare, command);
}

/// In `stickslip compare` a plain -- stands between two lists; to the parser that is an option with values,
/// after which options may follow.
std::vector<std::string> words(int count, char** arguments) {
  std::vector<std::string> words(arguments + 1, arguments + count);
  if (!words.empty() && words.front() == "compare") {
    if (const auto mark = std::find(words.begin(), words.end(), "--"); mark != words.end())
      *mark = kOtherMaterial;
  }
  std::reverse(words.begin(), words.end());  // As CLI11 takes them.
  return words;
}

/// The command as a shell would take it again.
std::string command_line(int count, char** arguments) {
  std::string line = "stickslip";
  for (int i = 1; i < count; ++i) line += " " + shell_word(arguments[i]);
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

  SweepCommand sweep;
  add_sweep(app, sweep);
  PlotCommand plot;
  add_plot(app, plot);

  AccuracyCommand accuracy;
  add_accuracy(app, accuracy);

  ReportCommand report;
  add_report(app, report);

  CompareCommand comparison;
  add_compare(app, comparison);

  std::string folder;
  bool scenes_json = false;
  CLI::App* scenes = app.add_subcommand("scenes", "list the shipped scenes");
  scenes->add_option("--folder", folder, "another folder of scenes")->type_name("DIR");
  scenes->add_flag("--json", scenes_json, "JSON instead of lines");

  std::vector<std::string> devices;
  bool boards_json = false;
  CLI::App* boards = app.add_subcommand(
      "boards",
      "list the boards under Linux Comedi and what a configuration should say; 1 if none can be used");
  boards->add_option("devices", devices, "only these; else all of /dev/comedi*")->type_name("DEVICE");
  boards->add_flag("--json", boards_json, "JSON instead of text");

  std::string method_folder;
  bool methods_json = false;
  CLI::App* methods = app.add_subcommand("methods", "list the shipped test methods");
  methods->add_option("--folder", method_folder, "another folder of methods")->type_name("DIR");
  methods->add_flag("--json", methods_json, "JSON instead of lines, with all settings and what to check");

  AnalyzeCommand analysis;
  CLI::App* analyze = app.add_subcommand("analyze", "run the detector and the estimators over records");
  analyze->add_option("files", analysis.files, "records")->required()->type_name("FILE.h5");
  add_method_option(*analyze, analysis.method);
  analyze
      ->add_option(
          "--tester", analysis.tester,
          "what `stickslip characterise` wrote: S and K become surer, and what speaks against it is told")
      ->type_name("FILE.toml");
  analyze
      ->add_option(
          "--estimator", analysis.estimator,
          "where S and K come from: \"peak\" (largest scan and mean of each cycle), \"interpolated\" "
          "(turning points), \"fit\" (all scans); default: as the record says")
      ->type_name("NAME");
  analyze->add_flag("--json", analysis.json,
                    "JSON instead of a table; names as in the record, null where absent");

  CharacteriseCommand characterisation;
  CLI::App* characterise =
      app.add_subcommand("characterise", "omega and gamma of the tester from its ring-downs");
  characterise->add_option("files", characterisation.files, "records of ring-downs")
      ->required()
      ->type_name("FILE.h5");
  characterise
      ->add_option("-o,--output", characterisation.output, "where to keep it, a file that does not exist")
      ->type_name("FILE.toml");
  characterise->add_flag("--json", characterisation.json, "JSON instead of a table");
  characterise->footer(
      "Examples:\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 -o tester.toml\n"
      "  stickslip analyze records/*.h5 --tester tester.toml");

  std::string socket = "/run/stickslip/control.sock";
  CLI::App* status = app.add_subcommand("status", "ask the running daemon");
  status->add_option("--socket", socket, "its control socket")->capture_default_str()->type_name("PATH");

  try {
    app.parse(words(count, arguments));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    fmt::print(stderr, "stickslip: {}; see stickslip --help\n", error.what());
    return 2;
  }
  if (analyze->parsed()) return print(run_analyze(analysis));
  if (characterise->parsed()) return print(run_characterise(characterisation));
  if (status->parsed()) return print(run_status(socket));
  if (boards->parsed()) {
    const BoardsOutput output = run_boards(devices, boards_json);
    fmt::print("{}", output.text);
    return output.any_usable && std::fflush(stdout) == 0 ? 0 : 1;
  }
  if (scenes->parsed()) return print(run_scenes(folder, scenes_json));
  if (methods->parsed()) return print(run_methods(method_folder, methods_json));
  if (app.got_subcommand("plot")) return print(run_plot(plot));
  if (app.got_subcommand("report")) return print(run_report(report));
  if (app.got_subcommand("compare")) return print(run_compare(comparison));
  if (app.got_subcommand("accuracy")) return print(run_accuracy(accuracy));
  if (app.got_subcommand("simulate")) {
    simulation.line = command_line(count, arguments);
    return print(run_simulate(simulation));
  }
  if (app.got_subcommand("sweep")) return print(run_sweep(sweep));
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
