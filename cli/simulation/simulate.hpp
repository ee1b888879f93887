/// \file
/// Simulates one repetition of a scene as a record, without board, threads and real time. Raw counts,
/// analysis, truth and names are those of a daemon that plays the scene, but the record holds the whole
/// scene, not only the test in it.
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

/// Most scans of a simulated record: 40 hours at 350 Hz.
inline constexpr std::int64_t kMostSimulatedScans = 50'000'000;

struct Simulation {
  record::Record record;        ///< Complete, except for process.program and process.configuration.
  std::int64_t scan_count = 0;  ///< Scans that arrived.
  std::string method;           ///< Method that solved the motion, its accuracy and the requested one.
  double time_taken_s = 0.0;    ///< Time of the simulation alone, without analysis and file.

  [[nodiscard]] double ns_per_scan() const noexcept;
  /// "2975 scans, 8.5 s at 350 Hz, seed 3; simulated in …"; also in the record.
  [[nodiscard]] std::string summary() const;
};

/// Called with the simulated part of the scans, 0 … 1; may be empty. \return whether to go on; else the error
/// is kInterrupted.
using SimulationProgress = std::function<bool(double done)>;

/// Simulates into memory, for pictures and comparisons of short scenes; blocks.
/// \param seed   decides the random numbers: equal seeds give equal bits. The seed in a record's truth
/// reproduces the record. \param clock  only measures the time taken. Errors: kUsage for a scene without a
/// scan, or with more than kMostSimulatedScans.
[[nodiscard]] base::Result<Simulation> simulate(const sim::Scene& scene, std::uint64_t seed,
                                                const base::Clock& clock,
                                                const SimulationProgress& progress = {});

/// Path and origin of a simulated record file.
struct SimulationFile {
  std::filesystem::path path;  ///< Must not exist.
  std::string program;         ///< process/program
  std::string configuration;   ///< process/configuration
  model::Method method{};      ///< process/method; results and truth follow it.
};

/// Simulates into a file with bounded memory, except for the fit of the slips (docs/simulate.md); blocks.
/// Long tables are in nameless files beside FILE, the scans in FILE.XXXXXXXX.journal, which is removed in any
/// case; one that a kill left behind is in nobody's way.
/// \param progress  called with 1 before the analysis and again before the file is built. \return the
/// simulation without scans, raw values, noise-free force and tables of slips and modes. Errors: as
/// simulate(); kUsage if the file exists, kFailure if it cannot be written.
[[nodiscard]] base::Result<Simulation> simulate_to_file(const sim::Scene& scene, std::uint64_t seed,
                                                        const base::Clock& clock, const SimulationFile& file,
                                                        const SimulationProgress& progress = {});

}  // namespace stickslip::simulation
