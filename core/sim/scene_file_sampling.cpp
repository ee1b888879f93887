#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {

using base::Dimension;
using base::Limits;
using base::Settings;

namespace {

/// The worst RC clocks are off by a hundredth; quartz by 1e-4.
constexpr double kLargestRateError = 0.01;
/// Scans come in order: with more jitter some would overtake others.
constexpr double kLargestJitter_scans = 0.1;
constexpr double kLongestBurst_scans = 1e9;

}  // namespace

void read_sampling_effects(Settings effects, Scene& scene) {
  if (lists(effects, "clock_rate_error")) {
    scene.clock_rate_error =
        ClockRateError{effects.table("clock_rate_error")
                           .quantity("error", Dimension::kDimensionless,
                                     Limits::between(-kLargestRateError, kLargestRateError))};
  }
  if (lists(effects, "clock_jitter")) {
    scene.clock_jitter =
        ClockJitter{effects.table("clock_jitter")
                        .quantity("sd", Dimension::kTime,
                                  Limits::between(0.0, kLargestJitter_scans / scene.scan_rate_Hz))};
  }
  if (lists(effects, "missing_scans")) {
    Settings effect = effects.table("missing_scans");
    MissingScans missing;
    missing.rate_per_s =
        effect.quantity("rate", Dimension::kPerTime, Limits::above_up_to(0.0, scene.scan_rate_Hz));
    missing.mean_length_scans = effect.quantity("mean_length", Dimension::kDimensionless,
                                                Limits::between(1.0, kLongestBurst_scans), 1.0);
    scene.missing_scans = missing;
  }
}

}  // namespace stickslip::sim
