/// \file
/// The signal stage: effects on the load cell's voltage.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "core/sim/signal_settings.hpp"

namespace stickslip::sim {

/// Effect on the readings. It has its own state and its own random stream, if any. Call restart() first.
class SignalEffect {
 public:
  virtual ~SignalEffect() = default;

  /// Name of the effect in scenes.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Returns to the first scan.
  /// \param seed  of the scene's run; the effect's random stream is that of stream_seed(seed, name()).
  virtual void restart(std::uint64_t seed) = 0;
  /// Changes the next consecutive readings in place, from the first scan on; the values do not depend on the
  /// division into calls. Does not allocate.
  /// \param reading  V; the quantisation leaves counts.
  virtual void apply(std::span<double> reading) = 0;
};

// scan_rate_Hz is the true rate, > 0.
[[nodiscard]] std::unique_ptr<SignalEffect> make_white_noise(const WhiteNoise& settings);
[[nodiscard]] std::unique_ptr<SignalEffect> make_drift_noise(const DriftNoise& settings, double scan_rate_Hz);
[[nodiscard]] std::unique_ptr<SignalEffect> make_mains_hum(const MainsHum& settings, double scan_rate_Hz);
[[nodiscard]] std::unique_ptr<SignalEffect> make_spikes(const Spikes& settings, double scan_rate_Hz);

/// Converts volts to the nearest of the counts 0 … maxdata, from range_min_V to range_max_V; outside of them
/// to the nearest rail. It is the converter, so it comes last.
[[nodiscard]] std::unique_ptr<SignalEffect> make_quantisation(const Quantisation& settings);

}  // namespace stickslip::sim
