// How late a fall is told: exactly LiveDetector::kFallDelayScans after the force, the median of three scans,
// has fallen by the hysteresis. The rule is written here once more, straight on.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/detect/live_detector.hpp"
#include "core/signal/statistics.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::detect {
namespace {

double median_at(const std::vector<double>& scans, std::size_t k) {
  std::array<double, 3> three{scans[k - 1], scans[k], scans[k + 1]};
  std::ranges::sort(three);
  return three[1];
}

struct Turns {
  bool rising = false;
  bool falling = false;
  double high = 0.0;
  double low = 0.0;

  /// \return it has begun to fall.
  bool add(double value, double hysteresis) {
    high = falling ? high : std::max(high, value);
    low = rising ? low : std::min(low, value);
    if (!falling && value < high - hysteresis) {
      low = value;
      rising = false;
      return falling = true;
    }
    if (!rising && value > low + hysteresis) {
      high = value;
      falling = false;
      rising = true;
    }
    return false;
  }
};

/// Scans at which `value_at` has fallen by the hysteresis, once the bench is loaded.
template <typename ValueAt>
std::vector<std::int64_t> falls(std::size_t count, double hysteresis, const ValueAt& value_at) {
  Turns turns;
  std::vector<std::int64_t> found;
  for (std::size_t k = 1; k + 1 < count; ++k) {
    if (turns.add(value_at(k), hysteresis)) found.push_back(static_cast<std::int64_t>(k));
  }
  return found;
}

RC_GTEST_PROP(FallDelay, IsFourScans, ()) {
  test::LiveScene scene;
  scene.scan_rate_Hz = *rc::gen::element(350.0, 1000.0);
  scene.Q = 0.01 * *rc::gen::inRange(20, 190);
  scene.slips = *rc::gen::inRange(1, 12);
  scene.escape_Q = *rc::gen::arbitrary<bool>() ? 3.0 : 0.0;
  scene.scatter = 0.1 * *rc::gen::inRange(0, 3);
  scene.sigma = *rc::gen::element(0.0, 1e-4);
  scene.seed = *rc::gen::arbitrary<std::uint32_t>();
  // A coarse board: its step, not what the scans show, is the noise, so that the hysteresis is known here.
  LiveSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.step_coefficient = 0.002;
  const double hysteresis = SlipRule::kHysteresisSigmas * signal::kRoundingSigma * settings.step_coefficient;

  test::LiveTrial trial{scene};
  LiveDetector detector{settings};
  std::vector<double> scans;
  std::vector<FallBegun> told;
  while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) {
    scans.push_back(trial.next());
    static_cast<void>(detector.add(scans.back(), false));
    if (const auto& fall = detector.fall_begun()) told.push_back(*fall);
  }

  const auto force = falls(scans.size(), hysteresis, [&](std::size_t k) { return median_at(scans, k); });
  const auto seen_by_then = [&](std::int64_t scan) {
    return scan + LiveDetector::kFallDelayScans < static_cast<std::int64_t>(scans.size());
  };
  RC_ASSERT(told.size() == static_cast<std::size_t>(std::ranges::count_if(force, seen_by_then)));
  // Without noise one of the scans themselves may be as low a scan earlier, where the highest stands alone.
  // With noise a lone scan is often low, which is why the detector looks at the median.
  const auto raw = falls(scans.size(), hysteresis, [&](std::size_t k) { return scans[k]; });
  RC_ASSERT(scene.sigma > 0.0 || raw.size() >= told.size());
  int late = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    RC_ASSERT(told[i].seen_scan == force[i] + LiveDetector::kFallDelayScans);
    RC_ASSERT(told[i].peak == median_at(scans, static_cast<std::size_t>(told[i].peak_scan)));
    RC_ASSERT(told[i].peak_scan < force[i]);
    if (scene.sigma > 0.0) continue;
    RC_ASSERT(force[i] - raw[i] >= 0 && force[i] - raw[i] <= 1);
    if (force[i] > raw[i]) ++late;
  }
  RC_CLASSIFY(late > 0, "a scan later than the scans themselves");
}

}  // namespace
}  // namespace stickslip::detect
