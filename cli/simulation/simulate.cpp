#include "cli/simulation/simulate.hpp"

#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/version.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/pipeline/sink.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "core/record/method_text.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"
#include "drivers/simulated/scene_facts.hpp"
#include "drivers/simulated/simulated_truth.hpp"

namespace stickslip::simulation {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
/// Scans between two progress reports; also the size of a journal entry, scans.
constexpr std::size_t kScansPerStep = 4096;

double seconds_since(std::int64_t start_ns, const base::Clock& clock) {
  return static_cast<double>(clock.monotonic_ns() - start_ns) / kNanosecondsPerSecond;
}

record::RecordHeader header_of(const sim::Scene& scene, const model::Method& method) {
  record::RecordHeader header;
  header.uuid = record::make_uuid();
  header.title = scene.name;
  header.board = drivers::board_info_of({scene}, scene.scan_rate_Hz);
  header.load_cell = drivers::load_cell_of(scene);
  header.tester = record::TesterFacts::of(drivers::tester_of({scene}));
  header.process.version = base::kVersion;
  header.process.commit = base::kCommit;
  header.process.method = record::method_text(method);
  return header;
}

tl::unexpected<base::Error> interrupted() {
  return tl::unexpected(base::Error{base::ErrorKind::kInterrupted, "interrupted: no file was made"});
}

/// Destination of the scans.
class ScanSink {
 public:
  virtual ~ScanSink() = default;
  /// Adds consecutive scans with their noise-free force.
  virtual base::Result<void> scans(daq::ScanIndex first, std::span<const double> raw,
                                   std::span<const double> force) = 0;
};

class MemorySink final : public ScanSink {
 public:
  explicit MemorySink(record::Record& record) : record_(record) {}

  base::Result<void> scans(daq::ScanIndex first, std::span<const double> raw,
                           std::span<const double> force) override {
    record_.scan.resize(record_.scan.size() + raw.size());
    std::iota(record_.scan.end() - static_cast<std::ptrdiff_t>(raw.size()), record_.scan.end(), first);
    record_.raw.insert(record_.raw.end(), raw.begin(), raw.end());
    record_.true_coefficient.insert(record_.true_coefficient.end(), force.begin(), force.end());
    return {};
  }

 private:
  record::Record& record_;
};

class JournalSink final : public ScanSink {
 public:
  explicit JournalSink(record::JournalWriter& journal) : journal_(journal) {}

  base::Result<void> scans(daq::ScanIndex first, std::span<const double> raw,
                           std::span<const double> force) override {
    if (auto written = journal_.append_scans(first, raw, {}); !written) return written;
    return journal_.append_true_coefficients(first, force);
  }

 private:
  record::JournalWriter& journal_;
};

/// Removes the journal in its destructor, after success and failure.
class JournalFile {
 public:
  explicit JournalFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~JournalFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

 private:
  std::filesystem::path path_;
};

base::Result<std::int64_t> scans_of(const sim::Scene& scene) {
  const double scan_count = scene.duration_s * scene.scan_rate_Hz;
  if (scan_count > static_cast<double>(kMostSimulatedScans)) {
    return base::usage_error(
        "scene {}: {:.4g} scans; one record may hold {}: a shorter --duration or a lower --rate", scene.name,
        scan_count, kMostSimulatedScans);
  }
  const std::int64_t count = sim::scan_count(scene, scene.scan_rate_Hz);
  if (count < 1) return base::usage_error("scene {}: lasts 0 s, so it has no scan", scene.name);
  return count;
}

/// Simulates and analyses a scene, and fills the record except for the facts of its file.
class Walk {
 public:
  /// \param scratch  folder of nameless files for long tables; empty: all is in memory.
  Walk(const sim::Scene& scene, std::uint64_t seed, const base::Clock& clock, std::filesystem::path scratch,
       model::Method traditional)
      : scene_(scene),
        seed_(seed),
        traditional_(std::move(traditional)),
        clock_(clock),
        scratch_(std::move(scratch)),
        run_(scene, scene.scan_rate_Hz) {
    run_.restart(seed);
  }

  base::Result<void> go(std::int64_t count, ScanSink& sink, const SimulationProgress& progress,
                        Simulation& result) {
    base::Result<evaluation::RecordAnalysis> analysis =
        evaluation::RecordAnalysis::make(result.record.header, scratch_);
    if (!analysis) return tl::unexpected(analysis.error());
    double analysis_s = 0.0;
    if (auto walked = walk(count, sink, progress, result, *analysis, analysis_s); !walked) return walked;
    const sim::SolverMethod method = run_.method();
    result.method =
        fmt::format("{}, accurate to {:.1g} ({:.1g} asked)", method.name, method.accuracy, scene_.accuracy);
    if (method.undecided_count > 0) {
      result.method += fmt::format(", captures too close to call: {}", method.undecided_count);
    }
    if (result.scan_count == 0) {
      return base::usage_error("scene {}: all its scans are missing", scene_.name);
    }
    const std::int64_t start_ns = clock_.monotonic_ns();
    record::EndRecord end;
    analysis->finish(end);
    end.compute_time_s = analysis_s + seconds_since(start_ns, clock_);
    end.cause = pipeline::name(pipeline::EndCause::kEndOfInput);
    end.truth = sim::scene_truth(scene_, scene_.scan_rate_Hz, seed_, traditional_, scratch_);
    end.truth->solver->time_per_scan_s = result.time_taken_s / static_cast<double>(result.scan_count);
    // Its times begin with the first scan that arrived.
    drivers::move_into_window(*end.truth, static_cast<double>(first_) / scene_.scan_rate_Hz,
                              scene_.duration_s, scratch_);
    record::set_end(result.record, std::move(end));
    result.record.header.process.simulation = result.summary();
    return {};
  }

 private:
  base::Result<void> walk(std::int64_t count, ScanSink& sink, const SimulationProgress& progress,
                          Simulation& result, evaluation::RecordAnalysis& analysis, double& analysis_s) {
    std::vector<double> raw(kScansPerStep);
    std::vector<double> force(kScansPerStep);
    std::optional<daq::ScanIndex> next;
    for (;;) {
      std::int64_t start_ns = clock_.monotonic_ns();
      const daq::ScanIndex first = run_.next_scan();
      const std::size_t arrived = run_.next(raw, force);
      result.time_taken_s += seconds_since(start_ns, clock_);
      if (arrived == 0) return {};
      if (!next) {
        first_ = first;
      } else if (first != *next) {
        // The cause that the daemon would note: a board does not tell it.
        result.record.gaps.push_back({*next, first - *next, false, daq::GapCause::kUnknown});
      }
      const std::span<const double> scans = std::span{raw}.first(arrived);
      if (auto told = sink.scans(first, scans, std::span{force}.first(arrived)); !told) return told;
      start_ns = clock_.monotonic_ns();
      analysis.add(first, scans);
      analysis_s += seconds_since(start_ns, clock_);
      next = first + static_cast<daq::ScanIndex>(arrived);
      result.scan_count += static_cast<std::int64_t>(arrived);
      if (progress && !progress(static_cast<double>(run_.next_scan()) / static_cast<double>(count)))
        return interrupted();
    }
  }

  const sim::Scene& scene_;
  std::uint64_t seed_;
  model::Method traditional_;
  const base::Clock& clock_;
  std::filesystem::path scratch_;
  sim::SceneRun run_;
  daq::ScanIndex first_ = 0;  ///< First scan that arrived.
};

std::string duration_text(double time_s) {
  if (time_s < 1e-3) return fmt::format("{:.3g} µs", time_s * 1e6);
  return time_s < 1.0 ? fmt::format("{:.3g} ms", time_s * 1e3) : fmt::format("{:.3g} s", time_s);
}

}  // namespace

double Simulation::ns_per_scan() const noexcept {
  return time_taken_s * kNanosecondsPerSecond / static_cast<double>(scan_count);
}

std::string Simulation::summary() const {
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  return fmt::format("{} scans, {:.10g} s at {} Hz, seed {}; simulated in {}, {:.3g} ns a scan; {}",
                     scan_count, static_cast<double>(scan_count) / rate_Hz, rate_Hz, record.end->truth->seed,
                     duration_text(time_taken_s), ns_per_scan(), method);
}

base::Result<Simulation> simulate(const sim::Scene& scene, std::uint64_t seed, const base::Clock& clock,
                                  const SimulationProgress& progress) {
  const base::Result<std::int64_t> count = scans_of(scene);
  if (!count) return tl::unexpected(count.error());
  Simulation result;
  result.record.header = header_of(scene, {});
  MemorySink sink{result.record};
  Walk walk{scene, seed, clock, {}, {}};
  if (auto gone = walk.go(*count, sink, progress, result); !gone) return tl::unexpected(gone.error());
  return result;
}

base::Result<Simulation> simulate_to_file(const sim::Scene& scene, std::uint64_t seed,
                                          const base::Clock& clock, const SimulationFile& file,
                                          const SimulationProgress& progress) {
  const base::Result<std::int64_t> count = scans_of(scene);
  if (!count) return tl::unexpected(count.error());
  if (auto free = record::check_publishable(file.path); !free) return tl::unexpected(free.error());
  Simulation result;
  result.record.header = header_of(scene, file.method);
  result.record.header.process.program = file.program;
  result.record.header.process.configuration = file.configuration;

  std::filesystem::path journal_path = file.path;
  journal_path += fmt::format(".{:.8}{}", result.record.header.uuid, record::kJournalExtension);
  base::Result<record::JournalWriter> journal =
      record::JournalWriter::create(journal_path, result.record.header);
  if (!journal) return tl::unexpected(journal.error());
  const JournalFile journal_file{journal_path};
  JournalSink sink{*journal};
  Walk walk{scene, seed, clock, journal_path.has_parent_path() ? journal_path.parent_path() : ".",
            file.method};
  try {
    if (auto gone = walk.go(*count, sink, progress, result); !gone) return tl::unexpected(gone.error());
  } catch (const std::system_error& error) {  // The scratch files.
    return base::failure("{}", error.what());
  }
  if (progress && !progress(1.0)) return interrupted();
  if (auto published = record::publish_journal(journal_path, result.record, file.path); !published) {
    return tl::unexpected(published.error());
  }
  // The file holds these tables.
  result.record.cycles.clear();
  result.record.end->truth->modes.clear();
  result.record.end->truth->cycles.clear();
  return result;
}

}  // namespace stickslip::simulation
