/// \file
/// One run of a sweep: the results and the truth that `stickslip simulate` would give, without the
/// record between.
#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/record/sweep.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sweep {

/// What one run needs: its memory goes with the scans of the scene, and all of it with the run.
/// Usage error that names the scene: without a scan, or with more than kMostSimulatedScans.
[[nodiscard]] base::Result<void> check_runnable(const sim::Scene& scene);

/// The same numbers for the same arguments, whoever else is running. Thread-safe.
/// \param scene   check_runnable(). \param number  stands in the run and does nothing else.
/// \throws std::invalid_argument if the analysis refuses the scene's tester.
[[nodiscard]] record::SweepRun sweep_run(const sim::Scene& scene, std::uint64_t seed, std::int64_t number,
                                         detect::EstimatorTier estimator = detect::EstimatorTier::kFit);

}  // namespace stickslip::sweep
