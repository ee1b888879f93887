// What it costs to make one second of a test durable: the journal as the disk thread writes it (ten entries,
// the cycles and clock readings of that second; write, fdatasync), beside h5py that appends the same counts
// with their coefficients, flushes the file and syncs it. Median and 99th percentile of the commits, the
// bytes of an hour of journal and of finished record, and the longest commit. The disk is that of TMPDIR.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "bench/bench_tester.hpp"
#include "bench/h5py_peer.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/patient_journal.hpp"

namespace {

using namespace stickslip;

constexpr double kRate_Hz = 350.0;
constexpr double kPull_s = 1200.0;
constexpr double kSecondsPerHour = 3600.0;

/// Of an odd or even number of them.
double quantile(std::vector<double> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void tell_commits(benchmark::State& state, const std::vector<double>& commits_s) {
  if (commits_s.empty()) return;
  state.counters["commits"] = static_cast<double>(commits_s.size());
  state.counters["median_us"] = 1e6 * quantile(commits_s, 0.5);
  state.counters["p99_us"] = 1e6 * quantile(commits_s, 0.99);
  state.counters["longest_us"] = 1e6 * quantile(commits_s, 1.0);
}

struct Pull {
  record::RecordHeader header;
  bench::Walk walk;
};

const Pull& pull() {
  static const Pull made = [] {
    bench::LongPull scene{kRate_Hz, kPull_s, 1};
    const drivers::OpenedBoard board = scene.open();
    Pull result{bench::record_header(board), {}};
    pipeline::Processor processor{
        bench::session_settings(board, detect::EstimatorTier::kTurningPoints).processor,
        daq::Calibration{board.board->info(), *board.load_cell, board.tester->normal_load_N()},
        {&result.walk}};
    for (const daq::ScanBlock& block : bench::all_blocks(*board.board))
      processor.process(block, daq::GapCause::kUnknown);
    processor.finish(pipeline::EndCause::kEndOfInput);
    return result;
  }();
  return made;
}

/// As storage thread and disk thread together, a second at a time.
class Committing final : public pipeline::Sink {
 public:
  explicit Committing(record::PatientJournal& journal) : journal_(journal) {}

  void scans(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> /*second*/,
             const daq::ClockStamp& stamp) override {
    if (pending_.empty()) pending_first_ = first;
    pending_.insert(pending_.end(), raw.begin(), raw.end());
    constexpr std::size_t kEntry = 35;  // A tenth of a second.
    if (pending_.size() < kEntry) return;
    journal_.add_scans(pending_first_, pending_, stamp);
    written_ += pending_.size();
    pending_.clear();
    if (written_ < static_cast<std::size_t>(kRate_Hz)) return;
    written_ = 0;
    // Two clock readings a second, as of a board in real time.
    journal_.add_anchor({first, stamp.monotonic_ns, stamp.realtime_ns});
    journal_.add_anchor({first, stamp.monotonic_ns, stamp.realtime_ns});
    const auto begin = std::chrono::steady_clock::now();
    if (journal_.save()) failed_ = true;
    commits_s_.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  void cycle(const detect::Cycle& cycle) override { journal_.add_cycle(cycle); }
  void test_ended(const pipeline::TestEnd& end) override {
    record::EndRecord record;
    record.cause = pipeline::name(end.cause);
    record.results = end.results;
    record.cycles = end.cycles;
    record.spikes = end.spikes;
    journal_.add_end(std::move(record));
    if (journal_.save()) failed_ = true;
  }
  [[nodiscard]] const std::vector<double>& commits_s() const { return commits_s_; }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  record::PatientJournal& journal_;
  std::vector<double> pending_;
  daq::ScanIndex pending_first_ = 0;
  std::size_t written_ = 0;
  std::vector<double> commits_s_;
  bool failed_ = false;
};

double per_hour(std::uintmax_t size) {
  return static_cast<double>(size) / static_cast<double>(pull().walk.scan_count()) * kRate_Hz *
         kSecondsPerHour;
}

void journal(benchmark::State& state) {
  for (auto _ : state) {
    const test::TemporaryFolder folder;
    const std::filesystem::path path = folder / "a.journal";
    {
      constexpr std::size_t kPlenty = std::size_t{1} << 24U;
      record::PatientJournal patient{path, pull().header, kPlenty};
      Committing sink{patient};
      pull().walk.hand_over(sink);
      if (sink.failed()) state.SkipWithError("the disk refused");
      tell_commits(state, sink.commits_s());
    }
    state.counters["journal_MB_per_h"] = 1e-6 * per_hour(std::filesystem::file_size(path));
    state.counters["counts_MB_per_h"] = 1e-6 * kRate_Hz * kSecondsPerHour * sizeof(std::uint16_t);
    const auto file = record::finalise(path);
    if (!file) {
      state.SkipWithError(file.error().message.c_str());
      continue;
    }
    state.counters["record_MB_per_h"] = 1e-6 * per_hour(std::filesystem::file_size(file->file));
  }
}
BENCHMARK(journal)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void peer_h5py(benchmark::State& state) {
  for (auto _ : state) {
    const auto written = bench::write_with_h5py(pull().walk.raw(), kRate_Hz, bench::Flush::kEachSecond);
    if (!written) {
      state.SkipWithError(written.error().message.c_str());
      continue;
    }
    tell_commits(state, written->commits_s);
    state.counters["record_MB_per_h"] = 1e-6 * per_hour(written->size);
  }
}
BENCHMARK(peer_h5py)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
