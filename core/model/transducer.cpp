#include "core/model/transducer.hpp"

#include <cmath>
#include <numbers>

#include "core/base/contract.hpp"

namespace stickslip::model {

bool Transducer::is_valid() const noexcept {
  const auto is_frequency = [](double frequency_Hz) {
    return frequency_Hz >= kSlowestTransducer_Hz && frequency_Hz <= kFastestTransducer_Hz;
  };
  const bool cell_is_valid =
      !load_cell || (is_frequency(load_cell->frequency_Hz) && load_cell->damping_ratio >= 0.0 &&
                     load_cell->damping_ratio <= kLargestCellDamping);
  const bool filter_is_valid =
      !anti_alias || (is_frequency(anti_alias->cutoff_Hz) && anti_alias->order >= 1 &&
                      anti_alias->order <= AntiAlias::kHighestOrder);
  return cell_is_valid && filter_is_valid;
}

TransducerResponse::TransducerResponse(const Transducer& transducer, double step_s) : step_s_(step_s) {
  STICKSLIP_EXPECTS(step_s > 0.0 && transducer.is_valid());
  if (transducer.load_cell)
    add_second_order(transducer.load_cell->frequency_Hz, transducer.load_cell->damping_ratio);
  if (!transducer.anti_alias) return;
  // Poles on a circle [Butterworth, Exp. Wireless 7:536, 1930]: pairs, and of an odd order a single one.
  const auto& [cutoff_Hz, order] = *transducer.anti_alias;
  if (order % 2 != 0) add_first_order(cutoff_Hz);
  for (int pair = 0; pair < order / 2; ++pair) {
    const double angle = std::numbers::pi * (2 * pair + 1 + order % 2) / (2 * order);
    add_second_order(cutoff_Hz, std::cos(angle));
  }
}

void TransducerResponse::add_first_order(double frequency_Hz) {
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  sections_.push_back({1.0 / omega, {{std::exp(-omega * step_s_), 0.0}, {0.0, 0.0}}});
}

void TransducerResponse::add_second_order(double frequency_Hz, double damping_ratio) {
  const double omega0 = 2.0 * std::numbers::pi * frequency_Hz;
  const double omega = omega0 * std::sqrt(1.0 - damping_ratio * damping_ratio);
  const double fade = std::exp(-damping_ratio * omega0 * step_s_);
  const double cosine = fade * std::cos(omega * step_s_);
  const double sine = fade * std::sin(omega * step_s_);
  const double ratio = damping_ratio * omega0 / omega;
  sections_.push_back(
      {2.0 * damping_ratio / omega0,
       {{cosine + ratio * sine, sine / omega}, {-omega0 * omega0 / omega * sine, cosine - ratio * sine}}});
}

void TransducerResponse::settle(double value, double rate_per_s) noexcept {
  input_ = value;
  for (Section& section : sections_) {
    value -= section.lag_s * rate_per_s;
    section.value = value;
    section.rate_per_s = rate_per_s;
  }
}

double TransducerResponse::next(double value) noexcept {
  double before = input_;
  input_ = value;
  for (Section& section : sections_) {
    // The line through both inputs is shown as itself, late; what differs from it decays.
    const double rate = (value - before) / step_s_;
    const double line = before - section.lag_s * rate;
    const double off = section.value - line;
    const double off_rate = section.rate_per_s - rate;
    before = section.value;
    section.value = line + rate * step_s_ + section.decay[0][0] * off + section.decay[0][1] * off_rate;
    section.rate_per_s = rate + section.decay[1][0] * off + section.decay[1][1] * off_rate;
    value = section.value;
  }
  return value;
}

double TransducerResponse::lag_s() const noexcept {
  double lag_s = 0.0;
  for (const Section& section : sections_) lag_s += section.lag_s;
  return lag_s;
}

double TransducerResponse::shown() const noexcept {
  return sections_.empty() ? input_ : sections_.back().value;
}

}  // namespace stickslip::model
