#include <algorithm>
#include <cmath>

#include "core/sim/signal_effect.hpp"

namespace stickslip::sim {
namespace {

class QuantisationEffect final : public SignalEffect {
 public:
  explicit QuantisationEffect(const Quantisation& settings)
      : range_min_V_(settings.range_min_V),
        maxdata_(static_cast<double>(settings.maxdata())),
        codes_per_V_(maxdata_ / (settings.range_max_V - settings.range_min_V)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "quantisation"; }

  void restart(std::uint64_t /*seed*/) override {}

  void apply(std::span<double> reading) override {
    for (double& value : reading) {
      value = std::clamp(std::round((value - range_min_V_) * codes_per_V_), 0.0, maxdata_);
    }
  }

 private:
  double range_min_V_;
  double maxdata_;
  double codes_per_V_;
};

}  // namespace

std::unique_ptr<SignalEffect> make_quantisation(const Quantisation& settings) {
  return std::make_unique<QuantisationEffect>(settings);
}

}  // namespace stickslip::sim
