#include "cli/simulation/simulate.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "cli/commands.hpp"
#include "cli/method_option.hpp"
#include "cli/progress.hpp"
#include "io/json_text.hpp"
#include "io/results_json.hpp"
#include "report/table.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using base::Result;

Result<simulation::Simulation> simulate_and_publish(const sim::Scene& scene, std::uint64_t seed,
                                                    const model::Method& method,
                                                    const SimulateCommand& command) {
  ProgressBar bar{scene.name};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  bool simulated = false;
  return simulation::simulate_to_file(
      scene, seed, *clock, {command.output, "stickslip simulate", command.line, method}, [&](double done) {
        bar.show(done);
        if (done == 1.0) bar.show(std::exchange(simulated, true) ? "writing" : "analysing");
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

}  // namespace

Result<std::string> run_simulate(const SimulateCommand& command) {
  const Result<ChosenScene> chosen = chosen_scene(command);
  if (!chosen) return tl::unexpected(chosen.error());
  const Result<model::Method> method = chosen_method(command.method);
  if (!method) return tl::unexpected(method.error());
  // Before the work, not only after it.
  if (auto free = record::check_publishable(command.output); !free) return tl::unexpected(free.error());

  const Result<simulation::Simulation> simulation =
      simulate_and_publish(chosen->scene, chosen->seed, *method, command);
  if (!simulation) return tl::unexpected(simulation.error());
  if (command.json) return json_of(*simulation, command.output);
  const record::EndRecord& end = *simulation->record.end;
  const std::vector<report::TableRow> rows{{1, end.results, end.truth, command.output}};
  return report::format_table(rows) + simulation->summary() + "\n";
}

}  // namespace stickslip::cli
