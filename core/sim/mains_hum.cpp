#include "core/sim/mains_hum.hpp"

#include <cmath>
#include <numbers>

#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {
namespace {

class MainsHumEffect final : public SignalEffect {
 public:
  MainsHumEffect(const MainsHum& settings, double scan_rate_Hz)
      : settings_(settings), scan_rate_Hz_(scan_rate_Hz) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "mains_hum"; }

  void restart(std::uint64_t /*seed*/) override { next_scan_ = 0; }

  void apply(std::span<double> reading) override {
    for (double& volts : reading) volts += mains_hum_V(settings_, scan_rate_Hz_, next_scan_++);
  }

 private:
  MainsHum settings_;
  double scan_rate_Hz_;
  std::int64_t next_scan_ = 0;
};

}  // namespace

double mains_cycles(double frequency_Hz, double scan_rate_Hz, std::int64_t scan) noexcept {
  const auto index = static_cast<double>(scan);
  const double product = frequency_Hz * index;
  const double rest = std::fma(frequency_Hz, index, -product);
  return (std::fmod(product, scan_rate_Hz) + rest) / scan_rate_Hz;
}

double mains_hum_V(const MainsHum& hum, double scan_rate_Hz, std::int64_t scan) noexcept {
  const double cycles = mains_cycles(hum.frequency_Hz, scan_rate_Hz, scan);
  double sum = 0.0;
  for (const MainsHum::Harmonic& harmonic : hum.harmonics) {
    const double turns = harmonic.order * cycles;
    const double angle = 2.0 * std::numbers::pi * (turns - std::round(turns));
    sum += harmonic.share * std::sin(angle + harmonic.phase_rad);
  }
  return hum.amplitude_V * sum;
}

std::unique_ptr<SignalEffect> make_mains_hum(const MainsHum& settings, double scan_rate_Hz) {
  return std::make_unique<MainsHumEffect>(settings, scan_rate_Hz);
}

}  // namespace stickslip::sim
