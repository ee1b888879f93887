// The ring between acquisition and processing, beside a queue with a mutex: cost of handing over
// one block of scans, both ends in one thread (no waiting, so only the queue is measured).

#include <benchmark/benchmark.h>

#include <deque>
#include <mutex>

#include "core/daq/scan_ring.hpp"

namespace {

using stickslip::daq::ScanBlock;
using stickslip::daq::ScanRing;

ScanBlock full_block() {
  ScanBlock block;
  block.count = ScanBlock::kMaxScans;
  return block;
}

void ring_hand_over(benchmark::State& state) {
  ScanRing ring{1024};
  ScanBlock block = full_block();
  for (auto _ : state) {
    ring.push(block);
    benchmark::DoNotOptimize(ring.pop(&block, 1));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ScanBlock::kMaxScans));
}
BENCHMARK(ring_hand_over);

void peer_mutex_deque_hand_over(benchmark::State& state) {
  std::mutex mutex;
  std::deque<ScanBlock> queue;
  ScanBlock block = full_block();
  for (auto _ : state) {
    {
      const std::lock_guard lock{mutex};
      queue.push_back(block);
    }
    const std::lock_guard lock{mutex};
    block = queue.front();
    queue.pop_front();
    benchmark::DoNotOptimize(block);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ScanBlock::kMaxScans));
}
BENCHMARK(peer_mutex_deque_hand_over);

}  // namespace
