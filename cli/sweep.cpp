#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/progress.hpp"
#include "cli/scene_library.hpp"
#include "cli/sweep/grid.hpp"
#include "cli/sweep/part_file.hpp"
#include "cli/sweep/run.hpp"
#include "cli/sweep/runner.hpp"
#include "cli/sweep/summary.hpp"
#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
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

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "else no signal handler may touch it");

extern "C" void ask_to_stop(int /*signal*/) { stop_asked.store(true); }

/// While it lives the first SIGINT or SIGTERM asks to stop; the next ends the program as ever.
class StopOnSignals {
 public:
  StopOnSignals() {
    stop_asked.store(false);
    struct sigaction action {};
    action.sa_handler = ask_to_stop;
    action.sa_flags =
        static_cast<int>(static_cast<unsigned>(SA_RESTART) | static_cast<unsigned>(SA_RESETHAND));
    ::sigaction(SIGINT, &action, &old_interrupt_);
    ::sigaction(SIGTERM, &action, &old_terminate_);
  }
  ~StopOnSignals() {
    ::sigaction(SIGINT, &old_interrupt_, nullptr);
    ::sigaction(SIGTERM, &old_terminate_, nullptr);
  }
  StopOnSignals(const StopOnSignals&) = delete;
  StopOnSignals& operator=(const StopOnSignals&) = delete;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

struct Sweep {
  record::SweepFacts facts;
  sweep::SweepPlan plan;
};

/// What decides the numbers, as one command.
std::string command_of(const SweepCommand& command) {
  std::string line = "stickslip sweep " + shell_word(command.scene);
  const auto add = [&line](const char* option, const std::string& value) {
    line += fmt::format(" {} {}", option, shell_word(value));
  };
  for (const std::string& effect : command.without) add("--without", effect);
  for (const std::string& setting : command.set) add("--set", setting);
  for (const std::string& axis : command.vary) add("--vary", axis);
  add("--repeat", command.repeat);
  if (!command.rate.empty()) add("--rate", command.rate);
  if (!command.duration.empty()) add("--duration", command.duration);
  if (!command.seed.empty()) add("--seed", command.seed);
  return line;
}

/// The scene of every point, so that a bad one is refused before the work and not in the midst of it.
Result<Sweep> sweep_of(const SweepCommand& command) {
  Sweep sweep;
  record::SweepFacts& facts = sweep.facts;
  const auto repeat = whole_number_of("--repeat", command.repeat, 1, sweep::kMostSweepRuns);
  if (!repeat) return tl::unexpected(repeat.error());
  facts.repeat = static_cast<std::int64_t>(*repeat);
  sweep.plan.repeat = facts.repeat;
  auto axes = sweep::parse_axes(command.vary, facts.repeat);
  if (!axes) return tl::unexpected(axes.error());
  facts.axes = *std::move(axes);
  const Result<sim::SceneChanges> common = changes_of(command);
  if (!common) return tl::unexpected(common.error());
  const Result<std::filesystem::path> file = find_scene(command.scene, command.folder);
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
    const Result<std::uint64_t> seed = seed_of(command, *scene);
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
  facts.command = command_of(command);
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
  const Result<void> done = sweep::do_runs(sweep.plan, missing, threads, stop_asked, take);
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

std::string json_of(const Sweep& sweep, const record::SweepTable& table, const SweepCommand& command,
                    std::int64_t threads, const Pace& pace) {
  Json axes = Json::array();
  for (const record::SweepAxis& axis : sweep.facts.axes) {
    Json& entry = axes.emplace_back(Json{{"key", axis.key}, {"unit", axis.unit}});
    entry["values"] = axis.words.empty() ? Json(axis.values) : Json(axis.words);
  }
  const Json json{{"file", command.output},
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

std::string text_of(const Sweep& sweep, const record::SweepTable& table, const SweepCommand& command,
                    std::int64_t threads, const Pace& pace) {
  const std::int64_t resumed = sweep.facts.run_count() - pace.run_count;
  return sweep::sweep_table_text(sweep.facts, table) +
         fmt::format(
             "{} runs{}, seed {}; {:.3g} s on {} thread{}, {:.3g} runs/s; {}\n", sweep.facts.run_count(),
             resumed == 0 ? "" : fmt::format(" ({} of them done before)", resumed), sweep.facts.seed,
             pace.time_taken_s, threads, threads == 1 ? "" : "s", pace.runs_per_second(), command.output);
}

Result<std::int64_t> threads_of(const SweepCommand& command) {
  if (command.threads.empty()) {
    return static_cast<std::int64_t>(std::max(std::thread::hardware_concurrency(), 1U));  // 0: unknown.
  }
  const auto threads = whole_number_of("--threads", command.threads, 1, kMostThreads);
  if (!threads) return tl::unexpected(threads.error());
  return static_cast<std::int64_t>(*threads);
}

}  // namespace

Result<std::string> run_sweep(const SweepCommand& command) {
  const Result<std::int64_t> threads = threads_of(command);
  if (!threads) return tl::unexpected(threads.error());
  if (auto free = record::check_publishable(command.output); !free) return tl::unexpected(free.error());
  const Result<Sweep> sweep = sweep_of(command);
  if (!sweep) return tl::unexpected(sweep.error());

  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  Result<sweep::PartFile> part = sweep::PartFile::open(command.output + ".part", sweep->facts, *clock);
  if (!part) return tl::unexpected(part.error());
  ProgressBar bar{sweep->facts.scene_name};
  const Result<Pace> pace = work(*sweep, *threads, *part, *clock, bar);
  if (!pace) return tl::unexpected(pace.error());

  bar.show("writing");
  const Result<record::SweepTable> table = part->table();
  if (!table) return tl::unexpected(table.error());
  if (auto published = record::publish_sweep(sweep->facts, *table, command.output); !published) {
    return tl::unexpected(published.error());
  }
  if (auto removed = part->remove(); !removed) return tl::unexpected(removed.error());
  return command.json ? json_of(*sweep, *table, command, *threads, *pace)
                      : text_of(*sweep, *table, command, *threads, *pace);
}

}  // namespace stickslip::cli
