#include <random>

#include <boost/random/normal_distribution.hpp>

#include "core/sim/random_stream.hpp"
#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {
namespace {

class WhiteNoiseEffect final : public SignalEffect {
 public:
  explicit WhiteNoiseEffect(const WhiteNoise& settings) : sd_V_(settings.sd_V) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "white_noise"; }

  void restart(std::uint64_t seed) override {
    generator_.seed(stream_seed(seed, name()));
    normal_.reset();
  }

  void apply(std::span<double> reading) override {
    for (double& volts : reading) volts += sd_V_ * normal_(generator_);
  }

 private:
  double sd_V_;
  std::mt19937_64 generator_;
  /// Boost's: the same numbers from every standard library.
  boost::random::normal_distribution<double> normal_;
};

}  // namespace

std::unique_ptr<SignalEffect> make_white_noise(const WhiteNoise& settings) {
  return std::make_unique<WhiteNoiseEffect>(settings);
}

}  // namespace stickslip::sim
