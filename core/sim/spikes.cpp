#include <cstdint>
#include <random>

#include <boost/random/exponential_distribution.hpp>
#include <boost/random/uniform_01.hpp>

#include "core/sim/random_stream.hpp"
#include "core/sim/scan_time.hpp"
#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {
namespace {

/// Goes from spike to spike, so that the scans between them cost nothing. Each spike draws its
/// waiting time, its sign and its size, in this order, from Boost's distributions: the same numbers
/// from every standard library.
class SpikesEffect final : public SignalEffect {
 public:
  SpikesEffect(const Spikes& settings, double scan_rate_Hz)
      : settings_(settings), mean_wait_scans_(scan_rate_Hz / settings.rate_per_s) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "spikes"; }

  void restart(std::uint64_t seed) override {
    generator_.seed(stream_seed(seed, name()));
    first_ = 0;
    spike_ = ScanTime{}.later(wait_scans());
  }

  void apply(std::span<double> reading) override {
    const std::int64_t end = first_ + static_cast<std::int64_t>(reading.size());
    while (spike_.scan < end) {
      const bool down = (generator_() >> 63U) != 0;
      const double size_V = settings_.mean_size_V * relative_size();
      reading[static_cast<std::size_t>(spike_.scan - first_)] += down ? -size_V : size_V;
      spike_ = spike_.later(wait_scans());
    }
    first_ = end;
  }

 private:
  double wait_scans() { return mean_wait_scans_ * exponential_(generator_); }

  /// Of mean 1.
  double relative_size() {
    switch (settings_.sizes) {
      case Spikes::Sizes::kFixed:
        break;
      case Spikes::Sizes::kUniform:
        return 2.0 * boost::random::uniform_01<double>{}(generator_);
      case Spikes::Sizes::kExponential:
        return exponential_(generator_);
    }
    return 1.0;
  }

  Spikes settings_;
  double mean_wait_scans_;
  std::mt19937_64 generator_;
  boost::random::exponential_distribution<double> exponential_{1.0};
  std::int64_t first_ = 0;  ///< Scan that the next reading belongs to.
  ScanTime spike_;          ///< The next one.
};

}  // namespace

std::unique_ptr<SignalEffect> make_spikes(const Spikes& settings, double scan_rate_Hz) {
  return std::make_unique<SpikesEffect>(settings, scan_rate_Hz);
}

}  // namespace stickslip::sim
