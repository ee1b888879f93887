/// \file
/// One run of a sweep: the results and the truth that `stickslip simulate` would give, without making a
/// record.
#pragma once

#include <cstdint>

#include "core/base/result.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/record/sweep.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::sweep {

/// Checks that a scene can be run in memory, which grows with its scans. Errors: kUsage, with the scene's
/// name, for a scene without a scan or with more than kMostSimulatedScans.
[[nodiscard]] base::Result<void> check_runnable(const sim::Scene& scene);

/// Simulates and analyses a scene; blocks. Equal arguments give equal numbers. Thread-safe.
/// \param scene   must have passed check_runnable(). \param number  is only copied into the result.
/// \throws std::invalid_argument if the analysis refuses the scene's tester.
[[nodiscard]] record::SweepRun sweep_run(const sim::Scene& scene, std::uint64_t seed, std::int64_t number,
                                         detect::EstimatorTier estimator = detect::EstimatorTier::kFit);

}  // namespace stickslip::sweep
