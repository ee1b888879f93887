/// \file
/// Measurements of `stickslip accuracy`: error against computing time of several methods on this machine, for
/// one scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/detection.hpp"
#include "core/accuracy/grazing.hpp"
#include "core/accuracy/tiers.hpp"
#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::accuracy_report {

/// Most scans of a scene: ten minutes at 350 Hz, for which the slowest method needs 10 s.
inline constexpr std::int64_t kMostComparedScans = 210'000;

struct AccuracyReport {
  std::string scene_name;
  std::string scene_description;
  std::int64_t scan_count = 0;
  double scan_rate_Hz = 0.0;
  double asked_accuracy = 0.0;  ///< The accuracy that the scene asks for.
  std::string chosen_method;    ///< The method that `simulate` chooses for it.
  std::string processor;        ///< Name of this machine's processor.
  accuracy::MotionComparison motion;
  double grazing_gamma_over_2omega = 0.0;
  std::vector<accuracy::GrazingRow> grazing;
  std::vector<accuracy::DetectionRow> detection;
  std::vector<accuracy::TierRow> tiers;
  std::string no_detection;  ///< Why `detection` is empty; empty if it is not.
};

/// Measures one scene; blocks for seconds. \param clock  measures the computing times. \param progress called
/// with the done part, 0 … 1. Errors: kUsage for a scene without a scan, or with more than
/// kMostComparedScans.
[[nodiscard]] base::Result<AccuracyReport> measure_accuracy(const sim::Scene& scene, std::uint64_t seed,
                                                            const base::Clock& clock,
                                                            const accuracy::Progress& progress = {});

}  // namespace stickslip::accuracy_report
