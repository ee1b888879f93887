#include "core/model/transducer.hpp"

#include <cmath>
#include <numbers>

#include "core/base/contract.hpp"

namespace stickslip::model {

bool Transducer::is_valid() const noexcept {
  const auto is_frequency = [](const std::optional<double>& frequency_Hz) {
    return !frequency_Hz || (*frequency_Hz > 0.0 && std::isfinite(*frequency_Hz));
  };
  return is_frequency(load_cell_frequency_Hz) && is_frequency(anti_alias_Hz) && load_cell_damping >= 0.0 &&
         load_cell_damping <= kLargestCellDamping && anti_alias_order >= kLowestFilterOrder &&
         anti_alias_order <= kHighestFilterOrder && anti_alias_order % 2 == 0;
}

TransducerResponse::TransducerResponse(const Transducer& transducer, double step_s) : step_s_(step_s) {
  STICKSLIP_EXPECTS(step_s > 0.0 && transducer.is_valid());
  if (transducer.load_cell_frequency_Hz)
    add_section(*transducer.load_cell_frequency_Hz, transducer.load_cell_damping);
  if (!transducer.anti_alias_Hz) return;
  const int order = transducer.anti_alias_order;
  // Poles on a circle [Butterworth, Exp. Wireless 7:536, 1930], in pairs.
  for (int pair = 0; pair < order / 2; ++pair)
    add_section(*transducer.anti_alias_Hz, std::cos(std::numbers::pi * (2 * pair + 1) / (2 * order)));
}

void TransducerResponse::add_section(double frequency_Hz, double damping) {
  const double omega0 = 2.0 * std::numbers::pi * frequency_Hz;
  const double omega = omega0 * std::sqrt(1.0 - damping * damping);
  const double fade = std::exp(-damping * omega0 * step_s_);
  const double cosine = fade * std::cos(omega * step_s_);
  const double sine = fade * std::sin(omega * step_s_);
  const double ratio = damping * omega0 / omega;
  sections_.push_back(
      {2.0 * damping / omega0,
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
