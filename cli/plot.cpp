#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/simulation/simulate.hpp"
#include "cli/subcommands.hpp"
#include "io/library.hpp"
#include "io/new_file.hpp"
#include "report/plot/figure.hpp"
#include "report/record_figure.hpp"

#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/read_apart.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::cli {
namespace {

using base::Dimension;
using base::Result;

struct PlotOptions {
  std::string input;   ///< A record; or a scene, as in SceneOptions.
  std::string output;  ///< Empty: the input's name with .svg, in the working folder.
  std::string folder;  ///< Of the shipped scenes, as in SceneOptions.
  std::string from;
  std::string to;
  bool overview = false;
  bool derivative = false;
};

Result<report::RecordView> view_of(const PlotOptions& options) {
  report::RecordView view;
  const auto from = number_of("--from", options.from, Dimension::kTime, false, base::BareNumber::kSi);
  if (!from) return tl::unexpected(from.error());
  const auto to = number_of("--to", options.to, Dimension::kTime, false, base::BareNumber::kSi);
  if (!to) return tl::unexpected(to.error());
  view.from_s = *from;
  view.to_s = *to;
  view.overview = options.overview;
  view.derivative = options.derivative;
  return view;
}

/// Scenes are TOML files or names; all other files are records.
bool is_record(const std::string& input) {
  std::error_code ignored;
  const std::filesystem::path file{input};
  return file.extension() != ".toml" &&
         (file.extension() == record::kRecordExtension || std::filesystem::exists(file, ignored));
}

/// \param title  becomes the scene's, in words.
Result<record::Record> record_of(const PlotOptions& options, std::string& title) {
  if (is_record(options.input)) return record::read_record_apart(options.input);
  const Result<std::filesystem::path> file = io::find_in(io::kScenes, options.input, options.folder);
  if (!file) return tl::unexpected(file.error());
  const Result<sim::Scene> scene = sim::load_scene(*file);
  if (!scene) return tl::unexpected(scene.error());
  title = scene->description;
  ProgressBar bar{scene->name};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  Result<simulation::Simulation> simulation =
      simulation::simulate(*scene, scene->seed, *clock, [&bar](double done) {
        bar.show(done);
        return true;
      });
  if (!simulation) return tl::unexpected(simulation.error());
  return std::move(simulation->record);
}

Result<std::string> run_plot(const PlotOptions& options) {
  Result<report::RecordView> view = view_of(options);
  if (!view) return tl::unexpected(view.error());
  const std::filesystem::path output =
      options.output.empty() ? std::filesystem::path{options.input}.filename().replace_extension(".svg")
                             : std::filesystem::path{options.output};
  // Before the work, not only after it.
  const Result<plot::PictureFormat> format = plot::format_of_file(output);
  if (!format) return tl::unexpected(format.error());
  if (auto free = record::check_publishable(output); !free) return tl::unexpected(free.error());

  const Result<record::Record> record = record_of(options, view->title);
  if (!record) return tl::unexpected(record.error());
  const Result<plot::Figure> figure = report::record_figure(*record, *view);
  if (!figure) {
    return tl::unexpected(base::Error{
        figure.error().kind, fmt::format("{}: {}", base::one_line(options.input), figure.error().message)});
  }
  const Result<std::string> picture = plot::draw(*figure, *format);
  if (!picture) return tl::unexpected(picture.error());
  if (auto written = io::write_new_file(output, *picture); !written) return tl::unexpected(written.error());
  return fmt::format("{}: {} scans\n", base::printable(output.string()), record->scan.size());
}

constexpr const char* kPlotExamples =
    R"(Draws the force over time, as SVG or PNG by the ending of -o. Shaded: the modes that the truth knows (stick, slip, slack). Dashed: S and K
of each slip in the truth. Points: the peaks that the detector found. A scene is simulated first, with its own
seed. Needs gnuplot (Debian package gnuplot-nox).

Examples:
  stickslip plot records/test-3.h5                     test-3.svg, the whole record
  stickslip plot pull.h5 -o onset.svg --from 0.9 --to "1.4 s"
  stickslip plot stick-slip-at-12-in-per-min -o fig3.svg --from 2 --to 3 --overview
  stickslip plot pull.h5 -o pull.png
  stickslip plot my-scene.toml -o speed.svg --from 2 --to 2.5 --derivative)";

}  // namespace

void add_plot(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command = app.add_subcommand("plot", "draw a record or a scene");
  command->footer(kPlotExamples);
  command->add_option("input", options->input, "record; or scene: file.toml, or name as in stickslip scenes")
      ->required()
      ->type_name("FILE.h5|SCENE");
  command
      ->add_option("-o,--output", options->output,
                   "picture to make, .svg or .png; must not exist; else the input's name with .svg, here")
      ->type_name("FILE.svg");
  command
      ->add_option("--from", options->from, "start of the part to show, s or with unit, after the first scan")
      ->type_name("T");
  command->add_option("--to", options->to, "end of the part to show")->type_name("T");
  command->add_flag("--overview", options->overview, "the whole record above, with the part marked");
  command->add_flag("--derivative", options->derivative, "the speed at which the coupling stretches below");
  command->add_option("--folder", options->folder, "of the scenes that have names")->type_name("DIR");
  choose(*command, chosen, [options] { return run_plot(*options); });
}

}  // namespace stickslip::cli
