#include "core/sim/paper.hpp"

#include "core/base/contract.hpp"

namespace stickslip::sim {

Paper::Paper(const PaperSettings& settings, const Coefficients& mean)
    : mean_(mean), now_(mean), ageing_(settings.contact_ageing) {
  STICKSLIP_EXPECTS(mean.mu_k >= 0.0 && mean.mu_s >= mean.mu_k);
  if (ageing_) STICKSLIP_EXPECTS(ageing_->per_decade >= 0.0 && ageing_->cutoff_s > 0.0);
  if (settings.scatter) {
    effects_.push_back(make_scatter(*settings.scatter));
    correlation_length_m_ = settings.scatter->correlation_length_m;
  }
  if (settings.first_peak) effects_.push_back(make_first_peak(*settings.first_peak));
}

void Paper::restart(std::uint64_t seed) {
  for (const auto& effect : effects_) effect->restart(seed);
}

void Paper::renew() {
  now_ = mean_;
  for (const auto& effect : effects_) effect->renew(now_);
}

void Paper::slipped(double rested_s) {
  now_.mu_s = static_limit(rested_s);
  for (const auto& effect : effects_) effect->slipped();
}

}  // namespace stickslip::sim
