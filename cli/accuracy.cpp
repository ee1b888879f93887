#include "cli/accuracy_report/accuracy.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "cli/accuracy_report/accuracy_table.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/subcommands.hpp"
#include "io/new_file.hpp"
#include "report/plot/figure.hpp"

#include "core/base/wording.hpp"
#include "core/record/finaliser.hpp"

namespace stickslip::cli {
namespace {

using base::Result;

constexpr std::string_view kSvg = ".svg";
constexpr std::string_view kHtml = ".html";

struct AccuracyOptions : SceneOptions {
  std::string output;  ///< .svg or .html; empty: none.
  bool json = false;
};

Result<void> check_output(const std::string& output) {
  const std::string ending = std::filesystem::path{output}.extension().string();
  if (ending != kSvg && ending != kHtml) {
    return base::usage_error("-o {}: must end with {} (picture) or {} (page)", base::one_line(output), kSvg,
                             kHtml);
  }
  return record::check_publishable(output);
}

Result<void> write_output(const accuracy_report::AccuracyReport& report, const std::string& output) {
  const Result<std::string> svg = plot::draw_svg(accuracy_report::accuracy_figure(report));
  if (!svg) return tl::unexpected(svg.error());
  const bool page = std::filesystem::path{output}.extension() == kHtml;
  return io::write_new_file(output, page ? accuracy_report::accuracy_page(report, *svg) : *svg);
}

Result<std::string> run_accuracy(const AccuracyOptions& options) {
  const Result<ChosenScene> chosen = chosen_scene(options);
  if (!chosen) return tl::unexpected(chosen.error());
  // Before the work, not only after it.
  if (!options.output.empty()) {
    if (auto free = check_output(options.output); !free) return tl::unexpected(free.error());
  }
  const Result<accuracy_report::AccuracyReport> report = [&] {
    ProgressBar bar{chosen->scene.name};
    const std::unique_ptr<base::Clock> clock = base::make_system_clock();
    return accuracy_report::measure_accuracy(chosen->scene, chosen->seed, *clock,
                                             [&bar](double done) { bar.show(done); });
  }();
  if (!report) return tl::unexpected(report.error());
  if (!options.output.empty()) {
    if (auto written = write_output(*report, options.output); !written)
      return tl::unexpected(written.error());
  }
  return options.json ? accuracy_report::accuracy_json(*report) : accuracy_report::accuracy_table(*report);
}

constexpr const char* kAccuracyExamples =
    R"(Computes the motion of a scene by every method there is, each at several settings, and compares with closed
forms in 50 digits (CVODE at its tightest for friction that has none): largest error of the coefficient, time
per simulated scan, and whether the capture near the threshold is found. Then the same for the estimators of
S - K. Changes apply in this order: --without, --set, --rate, --duration.

Examples:
  stickslip accuracy stick-slip-at-12-in-per-min
  stickslip accuracy threshold-oscillation -o accuracy.html
  stickslip accuracy my-scene.toml -o accuracy.svg --set paper.mu_s=0.34 --duration "20 s"
  stickslip accuracy ring-down-at-12-in-per-min --json)";

}  // namespace

void add_accuracy(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<AccuracyOptions>();
  CLI::App* command = app.add_subcommand("accuracy", "measure what accuracy costs in time, for one scene");
  command->footer(kAccuracyExamples);
  add_scene_options(*command, *options);
  command->add_option("-o,--output", options->output, "picture or page to make; must not exist")
      ->type_name("FILE.svg|FILE.html");
  command->add_flag("--json", options->json, "JSON instead of a table");
  choose(*command, chosen, [options] { return run_accuracy(*options); });
}

}  // namespace stickslip::cli
