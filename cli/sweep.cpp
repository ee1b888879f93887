#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_on_signals.hpp"
#include "cli/subcommands.hpp"
#include "cli/sweep/grid.hpp"
#include "cli/sweep/part_file.hpp"
#include "cli/sweep/run.hpp"
#include "cli/sweep/runner.hpp"
#include "cli/sweep/summary.hpp"
#include "io/json_text.hpp"
#include "io/library.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
#include "core/base/shell_word.hpp"
#include "core/base/version.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/method_text.hpp"
#include "core/record/sweep_file.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

using base::Result;

constexpr std::uint64_t kMostThreads = 256;
constexpr double kNanosecondsPerSecond = 1e9;

struct SweepOptions : SceneOptions {
  std::string output;
  std::vector<std::string> vary;  ///< As parse_axis() takes them.
  std::string repeat = "1";
  std::string threads;  ///< Empty: as many as there are processors.
  bool json = false;
};

struct Sweep {
  record::SweepFacts facts;
  sweep::SweepPlan plan;
};

/// What decides the numbers, as one command.
std::string command_of(const SweepOptions& options) {
  std::string line = "stickslip sweep " + base::shell_word(options.scene);
  const auto add = [&line](const char* option, const std::string& value) {
    line += fmt::format(" {} {}", option, base::shell_word(value));
  };
  for (const std::string& effect : options.without) add("--without", effect);
  for (const std::string& setting : options.set) add("--set", setting);
  for (const std::string& axis : options.vary) add("--vary", axis);
  add("--repeat", options.repeat);
  if (!options.rate.empty()) add("--rate", options.rate);
  if (!options.duration.empty()) add("--duration", options.duration);
  if (!options.seed.empty()) add("--seed", options.seed);
  return line;
}

/// The scene of every point, so that a bad one is refused before the work and not in the midst of it.
Result<Sweep> sweep_of(const SweepOptions& options) {
  Sweep sweep;
  record::SweepFacts& facts = sweep.facts;
  const auto repeat = whole_number_of("--repeat", options.repeat, 1, sweep::kMostSweepRuns);
  if (!repeat) return tl::unexpected(repeat.error());
  facts.repeat = static_cast<std::int64_t>(*repeat);
  sweep.plan.repeat = facts.repeat;
  auto axes = sweep::parse_axes(options.vary, facts.repeat);
  if (!axes) return tl::unexpected(axes.error());
  facts.axes = *std::move(axes);
  const Result<sim::SceneChanges> common = changes_of(options);
  if (!common) return tl::unexpected(common.error());
  const Result<std::filesystem::path> file = io::find_in(io::kScenes, options.scene, options.folder);
  if (!file) return tl::unexpected(file.error());

  for (std::int64_t point = 0; point < facts.point_count(); ++point) {
    sim::SceneChanges changes = *common;
    const std::vector<std::size_t> indices = facts.indices_of(point);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::string value = sweep::value_text(facts.axes[i], indices[i]);
      const std::string& key = facts.axes[i].key;
      changes.changes.push_back({key, value, fmt::format("--vary {}={}", key, value)});
    }
    Result<sim::Scene> scene = sim::load_scene(*file, changes);
    if (!scene) return tl::unexpected(scene.error());
    if (auto runnable = sweep::check_runnable(*scene); !runnable) return tl::unexpected(runnable.error());
    const Result<std::uint64_t> seed = seed_of(options, *scene);
    if (!seed) return tl::unexpected(seed.error());
    if (point == 0) {
      facts.scene_name = scene->name;
      facts.scene_text = scene->text;
      facts.seed = *seed;
    }
    scene->text.clear();  // The same for all, but for the varied keys: no need to keep it.
    sweep.plan.points.push_back(*std::move(scene));
    sweep.plan.seeds.push_back(*seed);
  }
  facts.version = base::kVersion;
  facts.commit = base::kCommit;
  facts.command = command_of(options);
  facts.method = record::method_text({});
  return sweep;
}

std::string time_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

/// Of this call: runs done before it are none of its merit.
struct Pace {
  std::int64_t run_count = 0;
  double time_taken_s = 0.0;

  [[nodiscard]] double runs_per_second() const {
    return run_count == 0 ? 0.0 : static_cast<double>(run_count) / time_taken_s;
  }
};

/// Does what is missing. kInterrupted if it was asked to stop before the end.
Result<Pace> work(const Sweep& sweep, std::int64_t threads, sweep::PartFile& part, const base::Clock& clock,
                  ProgressBar& bar) {
  const StopOnSignals signals;
  const std::int64_t all = sweep.facts.run_count();
  const std::vector<std::int64_t> missing = part.missing();
  const std::int64_t start_ns = clock.monotonic_ns();
  Pace pace;
  const auto take = [&](const record::SweepRun& run) -> Result<void> {
    if (auto appended = part.append(run); !appended) return appended;
    ++pace.run_count;
    pace.time_taken_s = static_cast<double>(clock.monotonic_ns() - start_ns) / kNanosecondsPerSecond;
    const auto left = static_cast<double>(all - part.done_count());
    bar.show(
        static_cast<double>(part.done_count()) / static_cast<double>(all),
        fmt::format("{}/{} runs, {} left", part.done_count(), all, time_text(left / pace.runs_per_second())));
    return {};
  };
  const Result<void> done = sweep::do_runs(sweep.plan, missing, threads, StopOnSignals::asked(), take);
  if (auto synced = part.sync(); !synced) return tl::unexpected(synced.error());
  if (!done) return tl::unexpected(done.error());
  if (part.done_count() < all) {
    return tl::unexpected(base::Error{
        base::ErrorKind::kInterrupted,
        fmt::format("stopped after {} of {} runs, which are kept in {}: the same command goes on from there",
                    part.done_count(), all, part.path().string())});
  }
  return pace;
}

std::string json_of(const Sweep& sweep, const record::SweepTable& table, const SweepOptions& options,
                    std::int64_t threads, const Pace& pace) {
  Json axes = Json::array();
  for (const record::SweepAxis& axis : sweep.facts.axes) {
    Json& entry = axes.emplace_back(Json{{"key", axis.key}, {"unit", axis.unit}});
    entry["values"] = axis.words.empty() ? Json(axis.values) : Json(axis.words);
  }
  const Json json{{"file", options.output},
                  {"sweep",
                   {{"scene", sweep.facts.scene_name},
                    {"seed", sweep.facts.seed},
                    {"point_count", sweep.facts.point_count()},
                    {"repeat", sweep.facts.repeat},
                    {"run_count", sweep.facts.run_count()},
                    {"resumed_run_count", sweep.facts.run_count() - pace.run_count},
                    {"threads", threads},
                    {"time_taken", pace.time_taken_s},
                    {"runs_per_second", pace.runs_per_second()}}},
                  {"axes", std::move(axes)},
                  {"points", sweep::sweep_points_json(sweep.facts, table)}};
  return io::json_document(json);
}

std::string text_of(const Sweep& sweep, const record::SweepTable& table, const SweepOptions& options,
                    std::int64_t threads, const Pace& pace) {
  const std::int64_t resumed = sweep.facts.run_count() - pace.run_count;
  return sweep::sweep_table_text(sweep.facts, table) +
         fmt::format(
             "{} runs{}, seed {}; {:.3g} s on {} thread{}, {:.3g} runs/s; {}\n", sweep.facts.run_count(),
             resumed == 0 ? "" : fmt::format(" ({} of them done before)", resumed), sweep.facts.seed,
             pace.time_taken_s, threads, threads == 1 ? "" : "s", pace.runs_per_second(), options.output);
}

Result<std::int64_t> threads_of(const SweepOptions& options) {
  if (options.threads.empty()) {
    return static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));  // 0: unknown.
  }
  const auto threads = whole_number_of("--threads", options.threads, 1, kMostThreads);
  if (!threads) return tl::unexpected(threads.error());
  return static_cast<std::int64_t>(*threads);
}

Result<std::string> run_sweep(const SweepOptions& options) {
  const Result<std::int64_t> threads = threads_of(options);
  if (!threads) return tl::unexpected(threads.error());
  if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());
  const Result<Sweep> sweep = sweep_of(options);
  if (!sweep) return tl::unexpected(sweep.error());

  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  Result<sweep::PartFile> part = sweep::PartFile::open(options.output + ".part", sweep->facts, *clock);
  if (!part) return tl::unexpected(part.error());
  ProgressBar bar{sweep->facts.scene_name};
  const Result<Pace> pace = work(*sweep, *threads, *part, *clock, bar);
  if (!pace) return tl::unexpected(pace.error());

  bar.show("writing");
  const Result<record::SweepTable> table = part->table();
  if (!table) return tl::unexpected(table.error());
  if (auto published = record::publish_sweep(sweep->facts, *table, options.output); !published) {
    return tl::unexpected(published.error());
  }
  if (auto removed = part->remove(); !removed) return tl::unexpected(removed.error());
  return options.json ? json_of(*sweep, *table, options, *threads, *pace)
                      : text_of(*sweep, *table, options, *threads, *pace);
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
  stickslip sweep scattered-paper --repeat 1000 --duration "10 s" -o scatter.h5 --json)";

}  // namespace

void add_sweep(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand("sweep", "run a scene over a grid of its keys, on all processors");
  command->footer(kSweepExamples);
  add_scene_options(*command, *options);
  command->add_option("-o,--output", options->output, "file to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  command->add_option("--vary", options->vary, "key of the scene with its values; several make a grid")
      ->allow_extra_args(false)
      ->type_name("KEY=FROM:TO:N");
  command->add_option("--repeat", options->repeat, "runs at each point; 1 unless given")->type_name("N");
  command->add_option("--threads", options->threads, "else one for each processor")->type_name("N");
  command->add_flag("--json", options->json, "JSON instead of a table");
  choose(*command, chosen, [options] { return run_sweep(*options); });
}

}  // namespace stickslip::cli
