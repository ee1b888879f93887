#include <cmath>
#include <numbers>

#include "core/sim/bracket.hpp"
#include "core/sim/paper.hpp"

namespace stickslip::sim {

double ContactAgeing::growth(double rested_s) const noexcept {
  return per_decade / std::numbers::ln10 * std::log1p(rested_s / cutoff_s);
}

double ContactAgeing::growth_rate_per_s(double rested_s) const noexcept {
  return per_decade / std::numbers::ln10 / (cutoff_s + rested_s);
}

double ContactAgeing::growth_bend_per_s2(double rested_s) const noexcept {
  return growth_rate_per_s(rested_s) / (cutoff_s + rested_s);
}

double ContactAgeing::gives_way_s(double held, double rate, double mu_s, double rested_s) const {
  const auto excess = [&](double t_s) { return held + rate * t_s - mu_s - growth(rested_s + t_s); };
  // S grows fastest at first, so the excess falls until the rates are equal, and rises for ever after.
  const double lowest_s = std::fmax(0.0, per_decade / std::numbers::ln10 / rate - cutoff_s - rested_s);
  double step_s = std::fmax((mu_s - held) / rate, cutoff_s);
  while (excess(lowest_s + step_s) < 0.0) step_s *= 2.0;
  return rise_between(excess, lowest_s, lowest_s + step_s);
}

}  // namespace stickslip::sim
