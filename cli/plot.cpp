#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/scene_library.hpp"
#include "cli/simulation/simulate.hpp"
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

Result<report::RecordView> view_of(const PlotCommand& command) {
  report::RecordView view;
  const auto from = number_of("--from", command.from, Dimension::kTime, false);
  if (!from) return tl::unexpected(from.error());
  const auto to = number_of("--to", command.to, Dimension::kTime, false);
  if (!to) return tl::unexpected(to.error());
  view.from_s = *from;
  view.to_s = *to;
  view.overview = command.overview;
  view.derivative = command.derivative;
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
Result<record::Record> record_of(const PlotCommand& command, std::string& title) {
  if (is_record(command.input)) return record::read_record_apart(command.input);
  const Result<std::filesystem::path> file = find_scene(command.input, command.folder);
  if (!file) return tl::unexpected(file.error());
  const Result<sim::Scene> scene = sim::load_scene(*file);
  if (!scene) return tl::unexpected(scene.error());
  title = scene->description;
  ProgressBar bar{scene->name};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  Result<simulation::Simulation> simulation =
      simulation::simulate(*scene, scene->seed, *clock, [&bar](double done) { bar.show(done); });
  if (!simulation) return tl::unexpected(simulation.error());
  return std::move(simulation->record);
}

}  // namespace

Result<std::string> run_plot(const PlotCommand& command) {
  Result<report::RecordView> view = view_of(command);
  if (!view) return tl::unexpected(view.error());
  const std::filesystem::path output =
      command.output.empty() ? std::filesystem::path{command.input}.filename().replace_extension(".svg")
                             : std::filesystem::path{command.output};
  // Before the work, not only after it.
  if (auto free = record::check_publishable(output); !free) return tl::unexpected(free.error());

  const Result<record::Record> record = record_of(command, view->title);
  if (!record) return tl::unexpected(record.error());
  const Result<plot::Figure> figure = report::record_figure(*record, *view);
  if (!figure) {
    return tl::unexpected(base::Error{
        figure.error().kind, fmt::format("{}: {}", base::one_line(command.input), figure.error().message)});
  }
  const Result<std::string> svg = plot::draw_svg(*figure);
  if (!svg) return tl::unexpected(svg.error());
  if (auto written = io::write_new_file(output, *svg); !written) return tl::unexpected(written.error());
  return fmt::format("{}: {} scans\n", base::printable(output.string()), record->scan.size());
}

}  // namespace stickslip::cli
