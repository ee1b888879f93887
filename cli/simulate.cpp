#include "cli/simulation/simulate.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "cli/method_option.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/stop_on_signals.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/results_json.hpp"
#include "report/truth_table.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using base::Result;

struct SimulateOptions : SceneOptions {
  std::string method;  ///< As chosen_method() takes it.
  std::string output;
  bool json = false;
  std::string line;  ///< The whole command, for the record.
};

Result<simulation::Simulation> simulate_and_publish(const sim::Scene& scene, std::uint64_t seed,
                                                    const model::Method& method,
                                                    const SimulateOptions& options) {
  ProgressBar bar{scene.name};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  const StopOnSignals signals;
  bool simulated = false;
  return simulation::simulate_to_file(
      scene, seed, *clock, {options.output, "stickslip simulate", options.line, method}, [&](double done) {
        bar.show(done);
        if (done == 1.0) bar.show(std::exchange(simulated, true) ? "writing" : "analysing");
        return !StopOnSignals::asked();
      });
}

std::string json_of(const simulation::Simulation& simulation, const std::string& output) {
  const record::Record& record = simulation.record;
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  Json json{{"file", output},
            {"simulation",
             {{"scene", record.end->truth->scene_name},
              {"seed", record.end->truth->seed},
              {"scan_count", simulation.scan_count},
              {"scan_rate", rate_Hz},
              {"simulated_time", static_cast<double>(simulation.scan_count) / rate_Hz},
              {"time_taken", simulation.time_taken_s},
              {"ns_per_scan", simulation.ns_per_scan()},
              {"method", simulation.method}}}};
  json.update(io::results_json(record.end->results, true));
  return io::json_document(json);
}

Result<std::string> run_simulate(const SimulateOptions& options) {
  const Result<ChosenScene> chosen = chosen_scene(options);
  if (!chosen) return tl::unexpected(chosen.error());
  const Result<model::Method> method = chosen_method(options.method);
  if (!method) return tl::unexpected(method.error());
  // Before the work, not only after it.
  if (auto free = record::check_publishable(options.output); !free) return tl::unexpected(free.error());

  const Result<simulation::Simulation> simulation =
      simulate_and_publish(chosen->scene, chosen->seed, *method, options);
  if (!simulation) return tl::unexpected(simulation.error());
  if (options.json) return json_of(*simulation, options.output);
  const record::EndRecord& end = *simulation->record.end;
  const std::vector<report::TableRow> rows{{1, end.results, end.truth, options.output}};
  return report::format_table(rows) + simulation->summary() + "\n";
}

constexpr const char* kSimulateExamples =
    R"(Runs one repetition of a scene straight into a record: the same counts, analysis and truth as from the
daemon that plays it, but the record is the whole scene; the daemon would cut out the test.
Changes apply in this order: --without, --set, --rate, --duration.

Examples:
  stickslip simulate stick-slip-at-12-in-per-min -o pull.h5
  stickslip simulate my-scene.toml -o pull.h5 --seed 7 --json
  stickslip simulate threshold-oscillation -o above.h5 --set paper.mu_s=0.34 --set effects.white_noise.sd=0.002
  stickslip simulate stick-slip-at-12-in-per-min -o hour.h5 --duration "1 h"
  stickslip simulate stick-slip-at-12-in-per-min -o fast.h5 --rate "2 kHz" --without white_noise
  stickslip simulate ring-down-at-12-in-per-min -o slow.h5 --set "effects.constant_speed.pull_speed=6 in/min")";

}  // namespace

void add_simulate(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<SimulateOptions>();
  options->line = chosen.line;
  CLI::App* command = app.add_subcommand("simulate", "run a scene straight into a record, with its truth");
  command->footer(kSimulateExamples);
  add_scene_options(*command, *options);
  command->add_option("-o,--output", options->output, "record to make; must not exist")
      ->required()
      ->type_name("FILE.h5");
  add_method_option(*command, options->method);
  command->add_flag("--json", options->json, "JSON instead of a table; SI units, names as in the record");
  choose(*command, chosen, [options] { return run_simulate(*options); });
}

}  // namespace stickslip::cli
