/// \file
/// Does the runs of a sweep on several threads.
///
/// Worker threads draw run numbers from one counter. The caller's thread takes finished runs, in any order,
/// and does all input and output. A run depends on its number only, so the results do not depend on the
/// number of threads or on runs done before.
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
  std::vector<sim::Scene> points;    ///< Scenes of the points, without their texts.
  std::vector<std::uint64_t> seeds;  ///< Seeds of the points.
  std::int64_t repeat = 1;
  detect::EstimatorTier estimator = detect::EstimatorTier::kFit;

  [[nodiscard]] std::int64_t run_count() const noexcept {
    return static_cast<std::int64_t>(points.size()) * repeat;
  }
  /// Seed of a run, from its number and its point's seed.
  [[nodiscard]] std::uint64_t seed_of(std::int64_t run) const noexcept;
};

/// Takes a finished run. An error ends the sweep.
using TakeRun = std::function<base::Result<void>(const record::SweepRun&)>;

/// \param numbers  numbers of the runs to do. \param threads  ≥ 1; at most one for each run is started.
/// \param stop     when true no further run begins; running ones are finished and taken.
/// \param take     called on this thread. \return its first error, or kFailure if a run cannot be done.
[[nodiscard]] base::Result<void> do_runs(const SweepPlan& plan, std::span<const std::int64_t> numbers,
                                         std::int64_t threads, const std::atomic<bool>& stop,
                                         const TakeRun& take);

}  // namespace stickslip::sweep
