#include "daemon/simulate.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/wording.hpp"
#include "core/record/finaliser.hpp"
#include "core/sim/scene.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/progress.hpp"
#include "daemon/cli/scene_library.hpp"
#include "daemon/report/table.hpp"
#include "daemon/results_json.hpp"

namespace stickslip::daemon {
namespace {

using base::Dimension;
using base::Result;

/// First what is dropped, so that it can be set anew in another way.
Result<sim::SceneChanges> changes_of(const SimulateCommand& command) {
  sim::SceneChanges changes;
  for (const std::string& effect : command.without) {
    changes.changes.push_back({"effects." + effect, std::nullopt, "--without " + effect});
  }
  for (const std::string& setting : command.set) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      return base::usage_error("--set {}: needs a key and a value, such as paper.mu_s=0.34", setting);
    }
    changes.changes.push_back({setting.substr(0, equals), setting.substr(equals + 1), "--set " + setting});
  }
  const auto rate_Hz = number_of("--rate", command.rate, Dimension::kFrequency, true);
  if (!rate_Hz) return tl::unexpected(rate_Hz.error());
  if (*rate_Hz)
    changes.changes.push_back({"scan_rate", fmt::format("{} Hz", **rate_Hz), "--rate " + command.rate});
  const auto duration_s = number_of("--duration", command.duration, Dimension::kTime, true);
  if (!duration_s) return tl::unexpected(duration_s.error());
  if (*duration_s) changes.duration = {**duration_s, "--duration " + command.duration};
  return changes;
}

Result<std::uint64_t> seed_of(const SimulateCommand& command, const sim::Scene& scene) {
  if (command.seed.empty()) return scene.seed;
  std::uint64_t seed = 0;
  const char* const end = command.seed.data() + command.seed.size();
  const auto [stop, error] = std::from_chars(command.seed.data(), end, seed);
  if (error != std::errc{} || stop != end) {
    return base::usage_error("--seed {}: must be a whole number from 0 to {}", base::one_line(command.seed),
                             std::numeric_limits<std::uint64_t>::max());
  }
  return seed;
}

Result<Simulation> simulate_and_publish(const sim::Scene& scene, std::uint64_t seed,
                                        const SimulateCommand& command) {
  ProgressBar bar{scene.name};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  Result<Simulation> simulation = simulate(scene, seed, *clock, [&bar](double done) {
    bar.show(done);
    if (done == 1.0) bar.show("analysing");
  });
  if (!simulation) return simulation;
  simulation->record.header.process.program = "stickslip simulate";
  simulation->record.header.process.configuration = command.line;
  bar.show("writing");
  if (auto published = record::publish_record(simulation->record, command.output); !published) {
    return tl::unexpected(published.error());
  }
  return simulation;
}

std::string json_of(const Simulation& simulation, const std::string& output) {
  using Json = nlohmann::ordered_json;
  const record::Record& record = simulation.record;
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  Json json{{"file", output},
            {"simulation",
             {{"scene", record.end->truth->scene_name},
              {"seed", record.end->truth->seed},
              {"scan_count", record.raw.size()},
              {"scan_rate", rate_Hz},
              {"simulated_time", static_cast<double>(record.raw.size()) / rate_Hz},
              {"time_taken", simulation.time_taken_s},
              {"ns_per_scan", simulation.ns_per_scan()},
              {"method", simulation.method}}}};
  json.update(results_json(record.end->results, true));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Result<std::string> run_simulate(const SimulateCommand& command) {
  const Result<sim::SceneChanges> changes = changes_of(command);
  if (!changes) return tl::unexpected(changes.error());
  const Result<std::filesystem::path> file = find_scene(command.scene, command.folder);
  if (!file) return tl::unexpected(file.error());
  const Result<sim::Scene> scene = sim::load_scene(*file, *changes);
  if (!scene) return tl::unexpected(scene.error());
  const Result<std::uint64_t> seed = seed_of(command, *scene);
  if (!seed) return tl::unexpected(seed.error());
  // Before the work, not only after it.
  if (auto free = record::check_publishable(command.output); !free) return tl::unexpected(free.error());

  const Result<Simulation> simulation = simulate_and_publish(*scene, *seed, command);
  if (!simulation) return tl::unexpected(simulation.error());
  if (command.json) return json_of(*simulation, command.output);
  const record::EndRecord& end = *simulation->record.end;
  const std::vector<TableRow> rows{{1, end.results, end.truth, command.output}};
  return format_table(rows) + simulation->summary() + "\n";
}

}  // namespace stickslip::daemon
