#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {
namespace {

using base::Dimension;
using base::Limits;
using base::Settings;

/// Harmonics of a power supply are named up to this order. [IEC 61000-3-2]
constexpr int kHighestHarmonic = 40;
/// The drift's slowest part is far slower than a test, so that within one it looks like a trend.
constexpr double kLowestDriftFrequency_Hz = 0.001;
constexpr double kLeastDriftSpan = 10.0;

/// Volts, written as a coefficient (`key`), a force (`key`_force) or a voltage (`key`_voltage).
double read_size_V(Settings effect, const std::string& key, const Scene& scene) {
  const std::string force = key + "_force";
  const std::string voltage = key + "_voltage";
  const auto coefficient =
      effect.quantity_if_given(key, Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient));
  const auto force_N = effect.quantity_if_given(force, Dimension::kForce, Limits::at_least(0.0));
  const auto voltage_V =
      effect.quantity_if_given(voltage, Dimension::kVoltage, Limits::between(0.0, kHighestVoltage_V));
  const int given = static_cast<int>(effect.has(key)) + static_cast<int>(effect.has(force)) +
                    static_cast<int>(effect.has(voltage));
  if (given == 0) effect.refuse(key, fmt::format("must be given, or else {} or {}", force, voltage));
  if (given > 1) {
    effect.refuse(effect.has(voltage) ? voltage : force,
                  fmt::format("must not stand beside another {}: the effect has one", key));
  }
  const double newtons = force_N.value_or(coefficient.value_or(0.0) * scene.normal_load_N());
  return voltage_V.value_or(newtons / scene.load_cell.gain_N_per_V);
}

DriftNoise read_drift_noise(Settings effect, const Scene& scene) {
  DriftNoise drift;
  drift.sd_V = read_size_V(effect, "sd", scene);
  const double nyquist_Hz = scene.scan_rate_Hz / 2.0;
  drift.lowest_frequency_Hz = effect.quantity("lowest_frequency", Dimension::kFrequency,
                                              Limits::between(1e-9, nyquist_Hz), kLowestDriftFrequency_Hz);
  drift.highest_frequency_Hz = effect.quantity("highest_frequency", Dimension::kFrequency,
                                               Limits::above_up_to(0.0, nyquist_Hz), nyquist_Hz);
  if (drift.highest_frequency_Hz < kLeastDriftSpan * drift.lowest_frequency_Hz) {
    effect.refuse(effect.has("highest_frequency") ? "highest_frequency" : "lowest_frequency",
                  fmt::format("highest_frequency ({} Hz) must be at least {} times lowest_frequency ({} Hz)",
                              drift.highest_frequency_Hz, kLeastDriftSpan, drift.lowest_frequency_Hz));
  }
  return drift;
}

MainsHum read_mains_hum(Settings effect, const Scene& scene) {
  const Limits phase = Limits::between(-10.0, 10.0);
  MainsHum hum;
  hum.frequency_Hz =
      effect.quantity("frequency", Dimension::kFrequency, Limits::above_up_to(0.0, 1000.0), 50.0);
  hum.amplitude_V = read_size_V(effect, "amplitude", scene);
  hum.harmonics.push_back({1, 1.0, effect.quantity("phase", Dimension::kAngle, phase, 0.0)});
  for (Settings harmonic : effect.tables("harmonics")) {
    const int order = static_cast<int>(harmonic.integer("order", 2, kHighestHarmonic));
    const double share =
        harmonic.quantity("share", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient));
    hum.harmonics.push_back({order, share, harmonic.quantity("phase", Dimension::kAngle, phase, 0.0)});
  }
  return hum;
}

Spikes read_spikes(Settings effect, const Scene& scene) {
  constexpr std::array<std::pair<std::string_view, Spikes::Sizes>, 3> kSizes{
      {{"fixed", Spikes::Sizes::kFixed},
       {"uniform", Spikes::Sizes::kUniform},
       {"exponential", Spikes::Sizes::kExponential}}};
  Spikes spikes;
  // With more than one spike a scan they would be no single scans, but noise.
  spikes.rate_per_s =
      effect.quantity("rate", Dimension::kPerTime, Limits::above_up_to(0.0, scene.scan_rate_Hz));
  spikes.mean_size_V = read_size_V(effect, "mean_size", scene);
  spikes.sizes = effect.choice<Spikes::Sizes>("sizes", kSizes, Spikes::Sizes::kExponential);
  return spikes;
}

Quantisation read_quantisation(Settings effect) {
  const Limits voltage = Limits::between(-kHighestVoltage_V, kHighestVoltage_V);
  Quantisation converter;
  converter.bits = static_cast<int>(effect.integer("bits", 1, 32));
  converter.range_min_V = effect.quantity("range_min", Dimension::kVoltage, voltage);
  converter.range_max_V = effect.quantity("range_max", Dimension::kVoltage, voltage);
  if (converter.range_max_V <= converter.range_min_V) {
    effect.refuse("range_max", fmt::format("must be above range_min = {} V", converter.range_min_V));
  }
  return converter;
}

}  // namespace

void read_signal_effects(Settings effects, Scene& scene) {
  if (lists(effects, "white_noise")) {
    scene.white_noise = WhiteNoise{read_size_V(effects.table("white_noise"), "sd", scene)};
  }
  if (lists(effects, "drift_noise"))
    scene.drift_noise = read_drift_noise(effects.table("drift_noise"), scene);
  if (lists(effects, "mains_hum")) scene.mains_hum = read_mains_hum(effects.table("mains_hum"), scene);
  if (lists(effects, "spikes")) scene.spikes = read_spikes(effects.table("spikes"), scene);
  if (lists(effects, "quantisation")) scene.quantisation = read_quantisation(effects.table("quantisation"));
}

}  // namespace stickslip::sim
