#include "cli/accuracy_report/accuracy.hpp"

#include <filesystem>
#include <memory>

#include "cli/accuracy_report/accuracy_table.hpp"
#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "io/new_file.hpp"
#include "report/plot/figure.hpp"

#include "core/base/wording.hpp"
#include "core/record/finaliser.hpp"

namespace stickslip::cli {
namespace {

using base::Result;

constexpr std::string_view kSvg = ".svg";
constexpr std::string_view kHtml = ".html";

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

}  // namespace

Result<std::string> run_accuracy(const AccuracyCommand& command) {
  const Result<ChosenScene> chosen = chosen_scene(command);
  if (!chosen) return tl::unexpected(chosen.error());
  // Before the work, not only after it.
  if (!command.output.empty()) {
    if (auto free = check_output(command.output); !free) return tl::unexpected(free.error());
  }
  const Result<accuracy_report::AccuracyReport> report = [&] {
    ProgressBar bar{chosen->scene.name};
    const std::unique_ptr<base::Clock> clock = base::make_system_clock();
    return accuracy_report::measure_accuracy(chosen->scene, chosen->seed, *clock,
                                             [&bar](double done) { bar.show(done); });
  }();
  if (!report) return tl::unexpected(report.error());
  if (!command.output.empty()) {
    if (auto written = write_output(*report, command.output); !written)
      return tl::unexpected(written.error());
  }
  return command.json ? accuracy_report::accuracy_json(*report) : accuracy_report::accuracy_table(*report);
}

}  // namespace stickslip::cli
