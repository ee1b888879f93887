/// \file
/// The signal stage: effects on the load cell's voltage.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "core/sim/signal_settings.hpp"

namespace stickslip::sim {

/// One effect with its own state and its own random stream.
class SignalEffect {
 public:
  virtual ~SignalEffect() = default;

  /// Name of the effect in scenes.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Returns to the first scan.
  /// \param seed  of the scene's run; the effect adds its name to it.
  virtual void restart(std::uint64_t seed) = 0;
  /// Changes consecutive readings in place; the values do not depend on the division into calls. Does not
  /// allocate.
  virtual void apply(std::span<double> reading) = 0;
};

[[nodiscard]] std::unique_ptr<SignalEffect> make_white_noise(const WhiteNoise& settings);
[[nodiscard]] std::unique_ptr<SignalEffect> make_drift_noise(const DriftNoise& settings, double scan_rate_Hz);
[[nodiscard]] std::unique_ptr<SignalEffect> make_mains_hum(const MainsHum& settings, double scan_rate_Hz);
[[nodiscard]] std::unique_ptr<SignalEffect> make_spikes(const Spikes& settings, double scan_rate_Hz);

/// Volts → counts 0 … maxdata, nearest code; outside the range the nearest rail.
/// It is the converter, so it comes last.
[[nodiscard]] std::unique_ptr<SignalEffect> make_quantisation(const Quantisation& settings);

}  // namespace stickslip::sim
