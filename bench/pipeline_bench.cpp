// The whole walk as stickslipd runs it: simulated board, ring, processing thread, detector and estimators,
// storage thread, disk thread with the journal on the disk. The board is not paced and waits for a full ring,
// so its rate is the rate of the slowest thread. Below it the stages by themselves, each in one thread over
// the same scans: where the time goes. Beside them, in the same run and over the same scans, what is done
// without this program: NumPy, SciPy's chain and h5py.
//
//     bench_pipeline --benchmark_filter=whole
//
// Files go to TMPDIR; what stands there should be a disk.

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <limits>

#include "cli/accuracy_report/scipy_chain.hpp"

#include "bench/bench_tester.hpp"
#include "bench/h5py_peer.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/journal.hpp"
#include "daemon/storage/storage.hpp"

namespace {

using namespace stickslip;

/// Of some hundred thousand scans.
double one_test_s(std::int64_t scan_rate_Hz) { return scan_rate_Hz < 1000 ? 1200.0 : 60.0; }

bench::LongPull one_pull(std::int64_t scan_rate_Hz) {
  return {static_cast<double>(scan_rate_Hz), one_test_s(scan_rate_Hz), 1};
}

/// Of all scans: those before the test, 0.25 s, and after it, 2 s, are no part of it.
constexpr double kFewestStored = 0.95;

void per_scan(benchmark::State& state, std::size_t scans) {
  state.counters["per_scan"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(scans),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(scans));
}

/// A journal stays where it is: the record is made by another process, after the test.
base::Result<record::Finalised> keep_journal(const std::filesystem::path& journal,
                                             std::optional<std::int64_t> scans) {
  return record::Finalised{journal, scans.value_or(0), 0, {}};
}

/// Counts what the walk lost, which would make it fast.
class Losses final : public daemon::EventReceiver {
 public:
  void storage_waits(std::string_view why) override { why_ = why; }
  void recording_failed(std::int64_t /*test*/, std::string_view why) override { why_ = why; }
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  std::string why_;
};

std::int64_t scans_in_journals(const std::filesystem::path& folder) {
  std::int64_t scans = 0;
  for (const auto& file : std::filesystem::directory_iterator{folder}) {
    if (file.path().extension() != record::kJournalExtension) continue;
    const auto journal = record::read_journal(file.path(), record::JournalScans::kCount);
    if (journal) scans += static_cast<std::int64_t>(journal->scan_count);
  }
  return scans;
}

/// When the processing thread was done with the latest scans: behind detector and record sink.
class LatestScans final : public pipeline::Sink {
 public:
  void scans(daq::ScanIndex /*first*/, std::span<const double> /*raw*/,
             std::span<const std::int32_t> /*second*/, const daq::ClockStamp& /*stamp*/) override {
    at_ = std::chrono::steady_clock::now();
    timespec used{};
    static_cast<void>(::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used));
    processor_s_ = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }
  [[nodiscard]] std::chrono::steady_clock::time_point at() const { return at_; }
  /// That the processing thread had used by then: what others do on the machine does not count.
  [[nodiscard]] double processor_s() const { return processor_s_; }

 private:
  std::chrono::steady_clock::time_point at_;
  double processor_s_ = 0.0;
};

/// One test from the start of the board until its journal is durable. The time of a row is that of all; the
/// counters are the best rate while the test runs, the best with what is estimated once at its end, and the
/// least processor time of the processing thread for a scan while the test runs, which bounds the first.
void whole(benchmark::State& state, detect::EstimatorTier tier, double test_s) {
  using Seconds = std::chrono::duration<double>;
  bench::LongPull pull{static_cast<double>(state.range(0)), test_s, 1};
  double running = 0.0;
  double all = 0.0;
  double processing_s = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const test::TemporaryFolder folder;
    daemon::TestLog tests;
    Losses losses;
    LatestScans latest;
    runtime::SessionCounts counts;
    std::promise<void> ended;
    drivers::OpenedBoard board = pull.open();
    const runtime::SessionSettings settings = bench::session_settings(board, tier);
    const record::RecordHeader header = bench::record_header(board);
    board.truth = nullptr;  // A bench has none.
    storage::Storage storage{{folder.path()}, keep_journal, tests, losses};
    storage.use(header, nullptr);
    runtime::Session session{std::move(board),
                             settings,
                             {&storage, &latest},
                             {[] {}, [&ended](runtime::Acquisition::End) { ended.set_value(); }, {}},
                             counts};
    const auto begin = std::chrono::steady_clock::now();
    if (!session.start()) state.SkipWithError("the board does not start");
    session.start_processing();
    ended.get_future().wait();
    storage.stop();  // All is on the disk.
    const Seconds took = std::chrono::steady_clock::now() - begin;
    state.SetIterationTime(took.count());
    const auto scans = static_cast<double>(counts.scans);
    all = std::max(all, scans / took.count());
    running = std::max(running, scans / Seconds{latest.at() - begin}.count());
    processing_s = std::min(processing_s, latest.processor_s() / scans);
    if (!losses.why().empty()) state.SkipWithError(losses.why().c_str());
    if (counts.lost_scans != 0 || counts.dropped_scans != 0 ||
        static_cast<double>(scans_in_journals(folder.path())) < kFewestStored * scans)
      state.SkipWithError("scans were lost");
  }
  state.counters["running_scans_per_s"] = running;
  state.counters["all_scans_per_s"] = all;
  state.counters["processing_per_scan"] = processing_s;
}

void stage_simulator(benchmark::State& state) {
  bench::LongPull pull = one_pull(state.range(0));
  std::size_t scans = 0;
  for (auto _ : state) {
    const drivers::OpenedBoard board = pull.open();
    daq::ScanBlock block;
    scans = 0;
    if (!board.board->start()) state.SkipWithError("the board does not start");
    while (board.board->read(block, std::chrono::milliseconds{100}) == daq::ReadStatus::kScans)
      scans += block.count;
  }
  per_scan(state, scans);
}

void stage_ring(benchmark::State& state) {
  daq::ScanRing ring{1024};
  daq::ScanBlock block;
  block.count = daq::ScanBlock::kMaxScans;
  for (auto _ : state) {
    ring.push(block);
    benchmark::DoNotOptimize(ring.pop(&block, 1));
  }
  per_scan(state, daq::ScanBlock::kMaxScans);
}

/// Calibration, and where tests begin and end.
void stage_segmenter(benchmark::State& state) {
  bench::LongPull pull = one_pull(state.range(0));
  const drivers::OpenedBoard board = pull.open();
  const pipeline::SegmenterSettings settings =
      bench::session_settings(board, detect::EstimatorTier::kFit).processor.segmenter;
  const daq::Calibration calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()};
  const std::vector<daq::ScanBlock> blocks = bench::all_blocks(*board.board);
  std::size_t scans = 0;
  for (auto _ : state) {
    pipeline::Segmenter segmenter{settings};
    scans = 0;
    for (const daq::ScanBlock& block : blocks) {
      for (const double raw : block.scans()) {
        benchmark::DoNotOptimize(
            segmenter.observe(static_cast<daq::ScanIndex>(scans++), calibration.coefficient(raw)));
      }
    }
  }
  per_scan(state, scans);
}

/// The scans of the test one by one, and what is estimated at its end.
void stage_analysis(benchmark::State& state, detect::EstimatorTier tier, bool at_the_end) {
  bench::LongPull pull = one_pull(state.range(0));
  const drivers::OpenedBoard board = pull.open();
  analysis::AnalysisSettings settings = bench::session_settings(board, tier).processor.analysis;
  const daq::Calibration calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()};
  settings.step_coefficient = calibration.step_coefficient();
  const std::vector<daq::ScanBlock> blocks = bench::all_blocks(*board.board);
  std::size_t scans = 0;
  for (auto _ : state) {
    if (at_the_end) state.PauseTiming();
    analysis::TestAnalysis analysis{settings};
    scans = 0;
    for (const daq::ScanBlock& block : blocks) {
      for (const double raw : block.scans())
        analysis.add(static_cast<daq::ScanIndex>(scans++), calibration.coefficient(raw), false);
      benchmark::DoNotOptimize(analysis.take_new_cycles());
    }
    if (!at_the_end) continue;
    state.ResumeTiming();
    benchmark::DoNotOptimize(analysis.finish());
  }
  per_scan(state, scans);
}

/// All that the processing thread does, for a sink that does nothing.
void stage_processing(benchmark::State& state, detect::EstimatorTier tier) {
  bench::LongPull pull = one_pull(state.range(0));
  const drivers::OpenedBoard board = pull.open();
  const pipeline::ProcessorSettings settings = bench::session_settings(board, tier).processor;
  const daq::Calibration calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()};
  const std::vector<daq::ScanBlock> blocks = bench::all_blocks(*board.board);
  std::uint64_t scans = 0;
  for (auto _ : state) {
    pipeline::Sink nobody;
    pipeline::Processor processor{settings, calibration, {&nobody}};
    for (const daq::ScanBlock& block : blocks) processor.process(block, daq::GapCause::kUnknown);
    processor.finish(pipeline::EndCause::kEndOfInput);
    scans = processor.scan_count();
  }
  per_scan(state, scans);
}

bench::Walk walk_of(std::int64_t scan_rate_Hz) {
  bench::LongPull pull = one_pull(scan_rate_Hz);
  const drivers::OpenedBoard board = pull.open();
  bench::Walk walk;
  pipeline::Processor processor{
      bench::session_settings(board, detect::EstimatorTier::kTurningPoints).processor,
      daq::Calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()},
      {&walk}};
  for (const daq::ScanBlock& block : bench::all_blocks(*board.board))
    processor.process(block, daq::GapCause::kUnknown);
  processor.finish(pipeline::EndCause::kEndOfInput);
  return walk;
}

/// Storage and disk thread: until the journal of the test is durable.
void stage_journal(benchmark::State& state) {
  const bench::Walk walk = walk_of(state.range(0));
  bench::LongPull pull = one_pull(state.range(0));
  const record::RecordHeader header = bench::record_header(pull.open());
  for (auto _ : state) {
    const test::TemporaryFolder folder;
    daemon::TestLog tests;
    Losses losses;
    storage::Storage storage{{folder.path()}, keep_journal, tests, losses};
    storage.use(header, nullptr);
    walk.hand_over(storage);
    storage.stop();
    if (!losses.why().empty()) state.SkipWithError(losses.why().c_str());
  }
  per_scan(state, walk.scan_count());
}

/// The record from the journal, after the test.
void stage_record(benchmark::State& state) {
  const bench::Walk walk = walk_of(state.range(0));
  bench::LongPull pull = one_pull(state.range(0));
  const record::RecordHeader header = bench::record_header(pull.open());
  for (auto _ : state) {
    state.PauseTiming();
    const test::TemporaryFolder folder;
    daemon::TestLog tests;
    Losses losses;
    std::filesystem::path journal;
    {
      storage::Storage storage{
          {folder.path()},
          [&journal](const std::filesystem::path& ended, std::optional<std::int64_t> scans) {
            return keep_journal(journal = ended, scans);
          },
          tests,
          losses};
      storage.use(header, nullptr);
      walk.hand_over(storage);
      storage.stop();
    }
    state.ResumeTiming();
    if (!record::finalise(journal)) state.SkipWithError("no record");
  }
  per_scan(state, walk.scan_count());
}

/// One thread: counts to coefficients, peaks, file. Python tells the time itself.
void peer(benchmark::State& state) {
  const bench::Walk walk = walk_of(state.range(0));
  const auto rate_Hz = static_cast<double>(state.range(0));
  bench::LongPull pull = one_pull(state.range(0));
  const drivers::OpenedBoard board = pull.open();
  const daq::Calibration calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()};
  const std::vector<double> raw = walk.raw();
  std::vector<double> coefficient;
  coefficient.reserve(raw.size());
  for (const double code : raw) coefficient.push_back(calibration.coefficient(code));
  constexpr double kFrequency_Hz = 20.0;  // As the scene has it.
  for (auto _ : state) {
    const auto chain = accuracy_report::run_scipy_chain(
        std::vector<accuracy::TierScene>{{rate_Hz, kFrequency_Hz, {coefficient}}});
    const auto written = bench::write_with_h5py(raw, rate_Hz, bench::Flush::kAtTheEnd);
    if (!chain || !written) {
      state.SkipWithError((chain ? written.error() : chain.error()).message.c_str());
      continue;
    }
    state.counters["scipy_per_scan"] = 1e-9 * chain->front().ns_per_scan;
    state.counters["h5py_per_scan"] = written->write_s / static_cast<double>(raw.size());
  }
}

void register_all() {
  for (const int rate_Hz : {350, 10'000}) {
    const auto add = [rate_Hz](const std::string& name, auto function) {
      return benchmark::RegisterBenchmark(name.c_str(), function)
          ->Arg(rate_Hz)
          ->Unit(benchmark::kMillisecond);
    };
    for (const auto tier : {detect::EstimatorTier::kTurningPoints, detect::EstimatorTier::kFit}) {
      const std::string name{detect::name(tier)};
      add("whole/" + name, [=](benchmark::State& state) {
        whole(state, tier, one_test_s(rate_Hz));
      })->UseManualTime();
      add("stage/live_detector/" + name,
          [tier](benchmark::State& state) { stage_analysis(state, tier, false); });
      add("stage/estimate_at_the_end/" + name,
          [tier](benchmark::State& state) { stage_analysis(state, tier, true); });
      add("stage/processing/" + name, [tier](benchmark::State& state) { stage_processing(state, tier); });
    }
    // A rate that holds for ten million scans is no matter of caches and queues.
    add("sustained/turning-points",
        [=](benchmark::State& state) { whole(state, detect::EstimatorTier::kTurningPoints, 1e7 / rate_Hz); })
        ->UseManualTime()
        ->Iterations(1);
    add("stage/simulator", stage_simulator);
    add("stage/segmenter", stage_segmenter);
    add("stage/journal", stage_journal)->MeasureProcessCPUTime();
    add("stage/record", stage_record);
    add("peer", peer)->Iterations(1);
  }
  benchmark::RegisterBenchmark("stage/ring", stage_ring);
}

}  // namespace

int main(int argc, char** argv) {
  register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
