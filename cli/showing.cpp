// Subcommands that show what stands in records and scenes: plot, accuracy, report, compare.

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
namespace {

constexpr const char* kPlotExamples =
    R"(Draws the force over time, as SVG. Shaded: the modes that the truth knows (stick, slip, slack). Dashed: S and K
of each slip in the truth. Points: the peaks that the detector found. A scene is simulated first, with its own
seed. Needs gnuplot (Debian package gnuplot-nox).

Examples:
  stickslip plot records/test-3.h5                     test-3.svg, the whole record
  stickslip plot pull.h5 -o onset.svg --from 0.9 --to "1.4 s"
  stickslip plot stick-slip-at-12-in-per-min -o fig3.svg --from 2 --to 3 --overview
  stickslip plot my-scene.toml -o speed.svg --from 2 --to 2.5 --derivative)";

void add_plot(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<PlotCommand>();
  PlotCommand& command = *kept;
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
  choose(*plot, chosen, [kept] { return run_plot(*kept); });
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

void add_accuracy(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<AccuracyCommand>();
  AccuracyCommand& command = *kept;
  CLI::App* accuracy = app.add_subcommand("accuracy", "measure what accuracy costs in time, for one scene");
  accuracy->footer(kAccuracyExamples);
  add_scene_options(*accuracy, command);
  accuracy->add_option("-o,--output", command.output, "picture or page to make; must not exist")
      ->type_name("FILE.svg|FILE.html");
  accuracy->add_flag("--json", command.json, "JSON instead of a table");
  choose(*accuracy, chosen, [kept] { return run_accuracy(*kept); });
}

constexpr const char* kReportExamples =
    R"(Shows the results that stand in records of one material: coefficient against speed (Fig. 1 of the paper), mean,
scatter s_r, repeatability r = 2.8 s_r, 95 % confidence interval, outliers (named, never left out).

Examples:
  stickslip report records/*.h5
  stickslip report pull.h5 -o pull.html                one page with traces to zoom in; needs no network
  stickslip report --batch "liner 42" records          the tests of a batch that were not voided, and its limits
  stickslip report records/*.h5 --json --csv tests.csv)";

constexpr const char* kCompareExamples =
    R"(Compares two materials at each speed: difference with 95 % interval, Welch's t test, effect size (Hedges' g), and how
many tests of each would have found a difference as large with 80 % and 90 % probability.

Examples:
  stickslip compare thorold/*.h5 -- baie-comeau/*.h5 --label-a Thorold --label-b "Baie Comeau"
  stickslip compare a*.h5 -- b*.h5 -o comparison.html
  stickslip compare --batch-a "liner 42" --batch-b "liner 43" records -o comparison.html
  stickslip compare a*.h5 -- b*.h5 --json --csv comparison.csv)";

void add_report_options(CLI::App& command, ReportOptions& options) {
  command
      .add_option("-o,--output", options.page,
                  "page to make, one file with traces to zoom in; must not exist; \"-\": standard output")
      ->type_name("FILE.html");
  command.add_option("--csv", options.csv, "table to make; must not exist; \"-\": standard output")
      ->type_name("FILE.csv");
  command.add_flag("--json", options.json, "JSON instead of tables; SI units, null where there is no number");
}

void add_report(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<ReportCommand>();
  ReportCommand& command = *kept;
  CLI::App* report =
      app.add_subcommand("report", "replicates: means, repeatability, coefficient against speed");
  report->footer(kReportExamples);
  report->add_option("files", command.files, "records; with --batch the folder they are in")
      ->required()
      ->type_name("FILE.h5");
  report->add_option("--batch", command.batch, "all tests of a batch, by its identifier or name")
      ->type_name("BATCH");
  add_report_options(*report, command);
  choose(*report, chosen, [kept] { return run_report(*kept); });
}

void add_compare(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<CompareCommand>();
  CompareCommand& command = *kept;
  CLI::App* compare = app.add_subcommand("compare", "two materials: stickslip compare A… -- B…");
  compare->footer(kCompareExamples);
  compare->add_option("a", command.a, "records of the one; with --batch-a the folder of both batches")
      ->type_name("A.h5");
  compare->add_option(kOtherMaterial, command.b, "records of the other; a plain -- does the same")
      ->type_name("B.h5");
  compare->add_option("--batch-a", command.batch_a, "all tests of a batch, by its identifier or name")
      ->type_name("BATCH");
  compare->add_option("--batch-b", command.batch_b, "all tests of the other batch")->type_name("BATCH");
  compare->add_option("--label-a", command.label_a, "what the one is called")->type_name("NAME");
  compare->add_option("--label-b", command.label_b, "what the other is called")->type_name("NAME");
  add_report_options(*compare, command);
  choose(*compare, chosen, [kept] { return run_compare(*kept); });
}

}  // namespace

void add_showing_commands(CLI::App& app, Chosen& chosen) {
  add_plot(app, chosen);
  add_accuracy(app, chosen);
  add_report(app, chosen);
  add_compare(app, chosen);
}

}  // namespace stickslip::cli
