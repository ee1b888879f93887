#include "core/sim/drift_noise.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include <boost/random/normal_distribution.hpp>

#include "core/sim/random_stream.hpp"
#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {
namespace {

constexpr double kProcessesPerDecade = 2.0;

class DriftNoiseEffect final : public SignalEffect {
 public:
  DriftNoiseEffect(const DriftNoise& settings, double scan_rate_Hz)
      : processes_(drift_processes(settings, scan_rate_Hz)),
        process_sd_V_(settings.sd_V / std::sqrt(static_cast<double>(processes_.size()))) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "drift_noise"; }

  /// Begins as if it had gone on for ever.
  void restart(std::uint64_t seed) override {
    generator_.seed(stream_seed(seed, name()));
    normal_.reset();
    for (DriftProcess& process : processes_) process.value_V = process_sd_V_ * normal_(generator_);
  }

  void apply(std::span<double> reading) override {
    for (double& volts : reading) {
      for (DriftProcess& process : processes_) {
        volts += process.value_V;
        process.value_V = process.decay * process.value_V + process.step_V * normal_(generator_);
      }
    }
  }

 private:
  std::vector<DriftProcess> processes_;
  double process_sd_V_;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace

std::vector<DriftProcess> drift_processes(const DriftNoise& settings, double scan_rate_Hz) {
  const double decades = std::log10(settings.highest_frequency_Hz / settings.lowest_frequency_Hz);
  const double intervals = std::round(kProcessesPerDecade * decades);
  std::vector<DriftProcess> processes(static_cast<std::size_t>(intervals) + 1);
  const double sd_V = settings.sd_V / std::sqrt(static_cast<double>(processes.size()));
  for (std::size_t i = 0; i < processes.size(); ++i) {
    const double corner_Hz =
        settings.lowest_frequency_Hz * std::pow(10.0, decades * static_cast<double>(i) / intervals);
    const double exponent = -2.0 * std::numbers::pi * corner_Hz / scan_rate_Hz;
    processes[i].decay = std::exp(exponent);
    processes[i].step_V = sd_V * std::sqrt(-std::expm1(2.0 * exponent));
  }
  return processes;
}

double drift_density(const DriftNoise& settings, double scan_rate_Hz, double frequency_Hz) {
  const double cosine = std::cos(2.0 * std::numbers::pi * frequency_Hz / scan_rate_Hz);
  double density = 0.0;
  for (const DriftProcess& process : drift_processes(settings, scan_rate_Hz)) {
    const double a = process.decay;
    density += 2.0 / scan_rate_Hz * process.step_V * process.step_V / (1.0 - 2.0 * a * cosine + a * a);
  }
  return density;
}

std::unique_ptr<SignalEffect> make_drift_noise(const DriftNoise& settings, double scan_rate_Hz) {
  return std::make_unique<DriftNoiseEffect>(settings, scan_rate_Hz);
}

}  // namespace stickslip::sim
