/// \file
/// `stickslip accuracy` without its looks: what accuracy costs in time on this machine, for one scene.
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

/// Longest scene that is compared: ten minutes at 350 Hz. The slowest method needs 10 s for it.
inline constexpr std::int64_t kMostComparedScans = 210'000;

struct AccuracyReport {
  std::string scene_name;
  std::string scene_description;
  std::int64_t scan_count = 0;
  double scan_rate_Hz = 0.0;
  double asked_accuracy = 0.0;  ///< By the scene.
  std::string chosen_method;    ///< What `simulate` takes for it.
  std::string processor;        ///< Of this machine, as it calls itself.
  accuracy::MotionComparison motion;
  double grazing_gamma_over_2omega = 0.0;
  std::vector<accuracy::GrazingRow> grazing;
  std::vector<accuracy::DetectionRow> detection;
  std::vector<accuracy::TierRow> tiers;
  std::string no_detection;  ///< Why there is none; empty if there is.
};

/// \param progress  told 0 … 1.
/// Errors: kUsage for a scene without a scan, or with more than kMostComparedScans.
[[nodiscard]] base::Result<AccuracyReport> measure_accuracy(const sim::Scene& scene, std::uint64_t seed,
                                                            const base::Clock& clock,
                                                            const accuracy::Progress& progress = {});

}  // namespace stickslip::accuracy_report
