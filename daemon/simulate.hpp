/// \file
/// One repetition of a scene as a record, straight: no board, no threads, no waiting. Raw counts,
/// analysis, truth and names are those of a daemon that plays the scene, but the record is the
/// whole scene and not the part that the daemon would cut out as the test.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/record/record.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::daemon {

/// Longest record that is made in memory: 40 hours at 350 Hz, about 4 GB.
inline constexpr std::int64_t kMostSimulatedScans = 50'000'000;

struct Simulation {
  record::Record record;      ///< With its end; process.program and process.configuration are left open.
  std::string method;         ///< As sim::SceneRun::method().
  double time_taken_s = 0.0;  ///< By the simulation itself, without analysis and file.

  [[nodiscard]] double ns_per_scan() const noexcept;
  /// "2975 scans, 8.5 s at 350 Hz, seed 3; simulated in …"; also in the record.
  [[nodiscard]] std::string summary() const;
};

/// Told the part of the scans that has been simulated, 0 … 1; may be empty.
using SimulationProgress = std::function<void(double done)>;

/// \param seed   of the run: the same seed, the same bits. That of a record's truth repeats it.
/// \param clock  measures the time taken and nothing else.
/// Errors: kUsage for a scene without a scan, or with more than kMostSimulatedScans.
[[nodiscard]] base::Result<Simulation> simulate(const sim::Scene& scene, std::uint64_t seed,
                                                const base::Clock& clock,
                                                const SimulationProgress& progress = {});

}  // namespace stickslip::daemon
