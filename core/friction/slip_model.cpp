#include "core/friction/slip_model.hpp"

#include <cmath>
#include <limits>

#include "core/friction/capture.hpp"

namespace stickslip::friction {

SlipModel::SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured) noexcept
    : shared_(shared),
      slip_(slip),
      waveform_{slip.K, slip.S - slip.K, shared.r, shared.oscillator()},
      capture_s_(captured ? capture_time_s(waveform_, shared.r).value_or(waveform_.rise_end_time_s())
                          : std::numeric_limits<double>::infinity()) {}

SlipModelPoint SlipModel::slipping(double tau_s) const noexcept {
  // c = K + e^(−γτ/2) [D cos ωτ + B sin ωτ], B = (r + γD/2)/ω: (11) without a division by D.
  const auto& [omega, gamma, r] = shared_;
  const double D = slip_.S - slip_.K;
  const double B = (r + 0.5 * gamma * D) / omega;
  const double decay = std::exp(-0.5 * gamma * tau_s);
  const double cosine = std::cos(omega * tau_s);
  const double sine = std::sin(omega * tau_s);
  const double swing = decay * (D * cosine + B * sine);
  const double by_D = decay * (cosine + 0.5 * gamma / omega * sine);

  SlipModelPoint point;
  point.value = slip_.K + swing;
  point.by_slip = {-waveform_.rate(tau_s), by_D, 1.0 - by_D};
  point.by_shared = {decay * (tau_s * (B * cosine - D * sine) - B / omega * sine),
                     -0.5 * tau_s * swing + decay * 0.5 * D / omega * sine, decay * sine / omega};
  return point;
}

SlipModelPoint SlipModel::at(double time_s) const noexcept {
  const double tau_s = time_s - slip_.onset_s;
  if (tau_s < 0.0) {
    SlipModelPoint point;
    point.value = slip_.S + shared_.r * tau_s;
    point.by_slip = {-shared_.r, 1.0, 0.0};
    point.by_shared = {0.0, 0.0, tau_s};
    return point;
  }
  if (tau_s <= capture_s_) return slipping(tau_s);
  // c and c′ are continuous at the capture, so its shift drops out of the derivatives.
  SlipModelPoint point = slipping(capture_s_);
  const double since_s = tau_s - capture_s_;
  point.value += shared_.r * since_s;
  point.by_slip[0] = -shared_.r;
  point.by_shared[2] += since_s;
  return point;
}

}  // namespace stickslip::friction
