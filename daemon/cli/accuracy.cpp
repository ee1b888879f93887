#include "daemon/accuracy.hpp"

#include <filesystem>
#include <memory>

#include "core/base/wording.hpp"
#include "core/record/finaliser.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/cli/progress.hpp"
#include "daemon/cli/scene_options.hpp"
#include "daemon/new_file.hpp"
#include "daemon/plot/figure.hpp"
#include "daemon/report/accuracy_table.hpp"

namespace stickslip::daemon {
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

Result<void> write_output(const AccuracyReport& report, const std::string& output) {
  const Result<std::string> svg = draw_svg(accuracy_figure(report));
  if (!svg) return tl::unexpected(svg.error());
  const bool page = std::filesystem::path{output}.extension() == kHtml;
  return write_new_file(output, page ? accuracy_page(report, *svg) : *svg);
}

}  // namespace

Result<std::string> run_accuracy(const AccuracyCommand& command) {
  const Result<ChosenScene> chosen = chosen_scene(command);
  if (!chosen) return tl::unexpected(chosen.error());
  // Before the work, not only after it.
  if (!command.output.empty()) {
    if (auto free = check_output(command.output); !free) return tl::unexpected(free.error());
  }
  const Result<AccuracyReport> report = [&] {
    ProgressBar bar{chosen->scene.name};
    const std::unique_ptr<base::Clock> clock = base::make_system_clock();
    return measure_accuracy(chosen->scene, chosen->seed, *clock, [&bar](double done) { bar.show(done); });
  }();
  if (!report) return tl::unexpected(report.error());
  if (!command.output.empty()) {
    if (auto written = write_output(*report, command.output); !written)
      return tl::unexpected(written.error());
  }
  return command.json ? accuracy_json(*report) : accuracy_table(*report);
}

}  // namespace stickslip::daemon
