/// \file
/// The runs of a sweep on several threads.
///
/// Threads draw the numbers of runs from one counter; the caller's thread takes what they finish, in
/// any order, and does all input and output. A run depends on its number alone, so the results are the
/// same for any number of threads, and for any part of the runs done before.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/result.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/record/sweep.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sweep {

struct SweepPlan {
  std::vector<sim::Scene> points;    ///< Without their texts.
  std::vector<std::uint64_t> seeds;  ///< Of the points.
  std::int64_t repeat = 1;
  detect::EstimatorTier estimator = detect::EstimatorTier::kFit;

  [[nodiscard]] std::int64_t run_count() const noexcept {
    return static_cast<std::int64_t>(points.size()) * repeat;
  }
  /// From the seed of its point and its number.
  [[nodiscard]] std::uint64_t seed_of(std::int64_t run) const noexcept;
};

/// Takes a finished run; an error ends the sweep.
using TakeRun = std::function<base::Result<void>(const record::SweepRun&)>;

/// \param numbers  of the runs to do. \param threads  ≥ 1; no more than there are runs are started.
/// \param stop     once true no further run begins; those begun are finished and taken.
/// \param take     called on this thread. \return its first error, or kFailure if a run cannot be done.
[[nodiscard]] base::Result<void> do_runs(const SweepPlan& plan, std::span<const std::int64_t> numbers,
                                         std::int64_t threads, const std::atomic<bool>& stop,
                                         const TakeRun& take);

}  // namespace stickslip::sweep
