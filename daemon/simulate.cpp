#include "daemon/simulate.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "core/pipeline/sink.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "daemon/analyse.hpp"
#include "daemon/method_text.hpp"
#include "daemon/version.hpp"
#include "drivers/simulated/scene_facts.hpp"

namespace stickslip::daemon {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

double seconds_since(std::int64_t start_ns, const base::Clock& clock) {
  return static_cast<double>(clock.monotonic_ns() - start_ns) / kNanosecondsPerSecond;
}

record::RecordHeader header_of(const sim::Scene& scene) {
  record::RecordHeader header;
  header.uuid = record::make_uuid();
  header.title = scene.name;
  header.board = drivers::board_info_of({scene}, scene.scan_rate_Hz);
  header.load_cell = drivers::load_cell_of(scene);
  header.tester = record::TesterFacts::of(drivers::tester_of({scene}));
  header.process.version = kVersion;
  header.process.commit = kCommit;
  header.process.method = method_text({});
  return header;
}

std::string duration_text(double time_s) {
  if (time_s < 1e-3) return fmt::format("{:.3g} µs", time_s * 1e6);
  return time_s < 1.0 ? fmt::format("{:.3g} ms", time_s * 1e3) : fmt::format("{:.3g} s", time_s);
}

}  // namespace

double Simulation::ns_per_scan() const noexcept {
  return time_taken_s * kNanosecondsPerSecond / static_cast<double>(record.raw.size());
}

std::string Simulation::summary() const {
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  return fmt::format("{} scans, {:.10g} s at {} Hz, seed {}; simulated in {}, {:.3g} ns a scan; {}",
                     record.raw.size(), static_cast<double>(record.raw.size()) / rate_Hz, rate_Hz,
                     record.end->truth->seed, duration_text(time_taken_s), ns_per_scan(), method);
}

base::Result<Simulation> simulate(const sim::Scene& scene, std::uint64_t seed, const base::Clock& clock,
                                  const SimulationProgress& progress) {
  const double scan_count = scene.duration_s * scene.scan_rate_Hz;
  if (scan_count > static_cast<double>(kMostSimulatedScans)) {
    return base::usage_error(
        "scene {}: {:.4g} scans; one record may hold {}: a shorter --duration or a lower --rate", scene.name,
        scan_count, kMostSimulatedScans);
  }
  const auto count = static_cast<std::size_t>(sim::scan_count(scene, scene.scan_rate_Hz));
  if (count < 1) return base::usage_error("scene {}: lasts 0 s, so it has no scan", scene.name);

  Simulation result;
  result.method = sim::SceneRun::method();
  record::Record& record = result.record;
  record.header = header_of(scene);
  record.scan.resize(count);
  std::iota(record.scan.begin(), record.scan.end(), daq::ScanIndex{0});
  record.raw.resize(count);

  sim::SceneRun run{scene, scene.scan_rate_Hz};
  run.restart(seed);
  constexpr std::size_t kScansPerStep = 4096;  // Between two looks at the clock and the progress.
  for (std::size_t done = 0; done < count;) {
    const std::int64_t start_ns = clock.monotonic_ns();
    done += run.next(std::span{record.raw}.subspan(done, std::min(kScansPerStep, count - done)));
    result.time_taken_s += seconds_since(start_ns, clock);
    if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
  }

  const std::int64_t start_ns = clock.monotonic_ns();
  base::Result<record::EndRecord> end = analyse(record);
  if (!end) return tl::unexpected(end.error());
  end->compute_time_s = seconds_since(start_ns, clock);
  end->cause = pipeline::name(pipeline::EndCause::kEndOfInput);
  end->truth = sim::scene_truth(scene, scene.scan_rate_Hz, seed);
  record::set_end(record, std::move(*end));
  record.header.process.simulation = result.summary();
  return result;
}

}  // namespace stickslip::daemon
