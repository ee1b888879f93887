/// \file
/// One repetition of a scene as a record, straight: no board, no threads, no waiting. Raw counts,
/// analysis, truth and names are those of a daemon that plays the scene, but the record is the
/// whole scene and not the part that the daemon would cut out as the test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/model/method.hpp"
#include "core/record/record.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::simulation {

/// Longest record: 40 hours at 350 Hz.
inline constexpr std::int64_t kMostSimulatedScans = 50'000'000;

struct Simulation {
  record::Record record;        ///< With its end; process.program and process.configuration are left open.
  std::int64_t scan_count = 0;  ///< Those that arrived.
  std::string method;           ///< How the motion was solved, the accuracy in use and asked for.
  double time_taken_s = 0.0;    ///< By the simulation itself, without analysis and file.

  [[nodiscard]] double ns_per_scan() const noexcept;
  /// "2975 scans, 8.5 s at 350 Hz, seed 3; simulated in …"; also in the record.
  [[nodiscard]] std::string summary() const;
};

/// Told the part of the scans that has been simulated, 0 … 1; may be empty.
using SimulationProgress = std::function<void(double done)>;

/// The record in memory: for pictures and comparisons of short scenes.
/// \param seed   of the run: the same seed, the same bits. That of a record's truth repeats it.
/// \param clock  measures the time taken and nothing else.
/// Errors: kUsage for a scene without a scan, or with more than kMostSimulatedScans.
[[nodiscard]] base::Result<Simulation> simulate(const sim::Scene& scene, std::uint64_t seed,
                                                const base::Clock& clock,
                                                const SimulationProgress& progress = {});

/// What a file says about where it comes from.
struct SimulationFile {
  std::filesystem::path path;  ///< Must not exist.
  std::string program;         ///< process/program
  std::string configuration;   ///< process/configuration
  model::Method method{};      ///< process/method, and the rule of results and truth.
};

/// The same into a file, scan by scan and slip by slip: what grows with them lies in nameless files beside
/// FILE, but for what the fit of the slips needs (docs/simulate.md). The scans go to FILE.journal, which is
/// gone in the end, whatever happens. \param progress  told 1 once before the analysis and once more before
/// the file is built. \return the simulation without scans, raw values, noise-free force and tables of slips
/// and modes. Errors: as simulate(); kUsage if the file is there already, kFailure if it cannot be written.
[[nodiscard]] base::Result<Simulation> simulate_to_file(const sim::Scene& scene, std::uint64_t seed,
                                                        const base::Clock& clock, const SimulationFile& file,
                                                        const SimulationProgress& progress = {});

}  // namespace stickslip::simulation
