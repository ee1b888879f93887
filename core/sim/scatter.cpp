#include <algorithm>
#include <cmath>
#include <random>

#include <boost/random/normal_distribution.hpp>

#include "core/base/contract.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::sim {
namespace {

class ScatterEffect final : public PaperEffect {
 public:
  explicit ScatterEffect(const Scatter& settings)
      : mu_k_sd_(settings.mu_k_sd),
        // Of ln(S − K), from mean and coefficient of variation of S − K itself.
        log_sd_(std::sqrt(std::log1p(settings.delta_mu_cv * settings.delta_mu_cv))) {
    STICKSLIP_EXPECTS(settings.delta_mu_cv >= 0.0 && settings.mu_k_sd >= 0.0);
    STICKSLIP_EXPECTS(settings.correlation_length_m > 0.0);
  }

  [[nodiscard]] std::string_view name() const noexcept override { return "scatter"; }

  void restart(std::uint64_t seed) override {
    generator_.seed(stream_seed(seed, name()));
    normal_.reset();
  }

  void renew(Coefficients& contact) override {
    // Two numbers each time, in this order, so that one setting at zero does not move the other.
    const double log_delta = log_sd_ * normal_(generator_) - log_sd_ * log_sd_ / 2.0;
    const double delta_mu = (contact.mu_s - contact.mu_k) * std::exp(log_delta);
    contact.mu_k = std::max(0.0, contact.mu_k + mu_k_sd_ * normal_(generator_));
    contact.mu_s = contact.mu_k + delta_mu;
  }

 private:
  double mu_k_sd_;
  double log_sd_;
  std::mt19937_64 generator_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace

std::unique_ptr<PaperEffect> make_scatter(const Scatter& settings) {
  return std::make_unique<ScatterEffect>(settings);
}

}  // namespace stickslip::sim
