/// \file
/// Plays a scene as calibrated scans, without board, threads and files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/scan_index.hpp"
#include "core/daq/calibration.hpp"
#include "core/sim/scene_run.hpp"
#include "drivers/simulated/scene_facts.hpp"

namespace stickslip::sweep {

/// Calibration from the raw readings of SceneRun to the coefficient.
[[nodiscard]] inline daq::Calibration calibration_of(const sim::Scene& scene) {
  return {drivers::board_info_of({scene}, scene.scan_rate_Hz), drivers::load_cell_of(scene),
          drivers::tester_of({scene}).normal_load_N()};
}

/// Plays the scene once; blocks. \param add  called for each scan that arrives as add(scan, coefficient,
/// saturated). \param gap  called as gap(first, count) where scans are missing between two that arrive.
/// \return false if no scan arrived.
template <typename Add, typename Gap>
bool play(const sim::Scene& scene, std::uint64_t seed, const daq::Calibration& calibration, Add add,
          Gap gap) {
  sim::SceneRun run{scene, scene.scan_rate_Hz};
  run.restart(seed);
  std::array<double, 1024> raw{};
  base::ScanIndex expected = -1;  // Nothing is missing before the first scan that arrives.
  for (;;) {
    base::ScanIndex scan = run.next_scan();
    const std::size_t arrived = run.next(raw);
    if (arrived == 0) return expected >= 0;
    if (expected >= 0 && scan != expected) gap(expected, scan - expected);
    for (std::size_t i = 0; i < arrived; ++i) {
      add(scan++, calibration.coefficient(raw[i]), calibration.saturated(raw[i]));
    }
    expected = scan;
  }
}

}  // namespace stickslip::sweep
