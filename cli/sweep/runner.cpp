#include "cli/sweep/runner.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "cli/sweep/run.hpp"

#include "core/base/contract.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::sweep {
namespace {

/// Queue of finished runs from the workers to the caller's thread. It is bounded, so that a slow disk slows
/// the workers and memory does not fill. Thread-safe.
class Finished {
 public:
  explicit Finished(std::size_t workers) : workers_(workers), room_(4 * workers) {}

  void put(base::Result<record::SweepRun> run) {
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return runs_.size() < room_; });
    runs_.push_back(std::move(run));
    changed_.notify_all();
  }

  void worker_ends() {
    const std::lock_guard lock{mutex_};
    --workers_;
    changed_.notify_all();
  }

  /// Blocks until there is a run; nothing when all workers have ended and the queue is empty.
  std::optional<base::Result<record::SweepRun>> take() {
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return !runs_.empty() || workers_ == 0; });
    if (runs_.empty()) return std::nullopt;
    std::optional<base::Result<record::SweepRun>> run{std::move(runs_.front())};
    runs_.pop_front();
    changed_.notify_all();
    return run;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<base::Result<record::SweepRun>> runs_;
  std::size_t workers_;
  std::size_t room_;
};

base::Result<record::SweepRun> attempt(const SweepPlan& plan, std::int64_t number) {
  const auto& scene = plan.points[static_cast<std::size_t>(number / plan.repeat)];
  try {
    return sweep_run(scene, plan.seed_of(number), number, plan.estimator);
  } catch (const std::exception& error) {
    return base::failure("run {} of scene {} cannot be done: {}", number, scene.name, error.what());
  }
}

}  // namespace

std::uint64_t SweepPlan::seed_of(std::int64_t run) const noexcept {
  return sim::stream_seed(seeds[static_cast<std::size_t>(run / repeat)], static_cast<std::uint64_t>(run));
}

base::Result<void> do_runs(const SweepPlan& plan, std::span<const std::int64_t> numbers, std::int64_t threads,
                           const std::atomic<bool>& stop, const TakeRun& take) {
  STICKSLIP_EXPECTS(threads >= 1 && plan.seeds.size() == plan.points.size());
  const std::size_t count = std::min(static_cast<std::size_t>(threads), numbers.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  Finished finished{count};
  const auto work = [&] {
    while (!stop.load() && !failed.load()) {
      const std::size_t mine = next.fetch_add(1);
      if (mine >= numbers.size()) break;
      finished.put(attempt(plan, numbers[mine]));
    }
    finished.worker_ends();
  };
  std::vector<std::thread> workers;
  try {
    for (std::size_t i = 0; i < count; ++i) workers.emplace_back(work);
  } catch (const std::system_error& error) {
    if (workers.empty()) return base::failure("no thread can be started: {}", error.what());
    for (std::size_t i = workers.size(); i < count; ++i) finished.worker_ends();  // Fewer do it too.
  }

  base::Result<void> done;
  while (auto run = finished.take()) {
    if (!done) continue;  // After an error the rest is thrown away.
    if (*run) {
      done = take(**run);
    } else {
      done = tl::unexpected(run->error());
    }
    if (!done) failed.store(true);
  }
  for (std::thread& worker : workers) worker.join();
  return done;
}

}  // namespace stickslip::sweep
