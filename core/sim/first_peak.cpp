#include <algorithm>
#include <random>

#include <boost/random/normal_distribution.hpp>

#include "core/base/contract.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::sim {
namespace {

class FirstPeakEffect final : public PaperEffect {
 public:
  explicit FirstPeakEffect(const FirstPeak& settings) : settings_(settings) {
    STICKSLIP_EXPECTS(settings.sd >= 0.0);
  }

  [[nodiscard]] std::string_view name() const noexcept override { return "first_peak"; }

  void restart(std::uint64_t seed) override {
    std::mt19937_64 generator{stream_seed(seed, name())};
    boost::random::normal_distribution<double> normal;
    change_ = settings_.change + settings_.sd * normal(generator);
  }

  /// Contacts that do not give way, as when the belt starts, do not use the change up.
  void renew(Coefficients& contact) override {
    contact.mu_s = std::max(contact.mu_k, contact.mu_s + change_);
  }

  void slipped() override { change_ = 0.0; }

 private:
  FirstPeak settings_;
  double change_ = 0.0;
};

}  // namespace

std::unique_ptr<PaperEffect> make_first_peak(const FirstPeak& settings) {
  return std::make_unique<FirstPeakEffect>(settings);
}

}  // namespace stickslip::sim
