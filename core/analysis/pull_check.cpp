#include "core/analysis/pull_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/signal/noise.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Part of the largest force from which on a scan is loaded, and of the level below which it is not.
constexpr double kPulled = 0.25;
/// Smallest largest force, in σ, that is no noise.
constexpr double kLeastSigmas = 12.0;
constexpr double kJump = 0.5;
constexpr double kOvershoot = 0.05;
/// Loaded scans that tell the level: the first ones.
constexpr std::size_t kLevelScans = std::size_t{1} << 14U;
/// Shortest pull, s: the force of a touch is gone sooner than a segmenter with its usual settings believes
/// that a test is over (pipeline::SegmenterSettings::unload_dwell_s).
constexpr double kShortestPull_s = 0.25;

/// The last loaded scan must be followed by so many others.
constexpr std::size_t kScansBehind = 5;

double median_of_three(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

std::optional<NoPull> no_pull(const estimate::Trace& trace, double scan_rate_Hz) {
  const base::LongColumn<double>& value = trace.value;
  double largest = 0.0;
  for (std::size_t k = 1; k + 1 < value.size(); ++k)
    largest = std::max(largest, median_of_three(value[k - 1], value[k], value[k + 1]));
  if (largest < kLeastSigmas * signal::scan_noise(value, 0.0) || !(largest > 0.0)) return std::nullopt;
  std::vector<double> loaded;
  std::size_t first = value.size();
  std::size_t last = 0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    if (!(value[k] >= kPulled * largest)) continue;
    first = std::min(first, k);
    last = k;
    if (loaded.size() < kLevelScans) loaded.push_back(value[k]);
  }
  if (first == 0 || last + kScansBehind >= value.size()) return std::nullopt;
  NoPull found;
  found.level = signal::median_of(loaded.size(), [&](std::size_t i) { return loaded[i]; });
  found.loaded_s = trace.time_s[last] - trace.time_s[first];
  found.overshoot = largest / found.level - 1.0;
  if (found.loaded_s < kShortestPull_s) {
    found.is_brief = true;
    return found;
  }
  if (found.overshoot > kOvershoot) return std::nullopt;
  for (std::size_t k = first - 1; k + kJumpScans <= last; ++k) {
    const std::size_t end = k + kJumpScans;
    const bool whole = trace.time_s[end] - trace.time_s[k] < (kJumpScans + 0.5) / scan_rate_Hz;
    if (!whole || value[k] >= kPulled * found.level || value[end] - value[k] < kJump * found.level) continue;
    found.jump_at_scan = k + 1;
    return found;
  }
  return std::nullopt;
}

}  // namespace stickslip::analysis
