#include "core/friction/slip_model.hpp"

#include <cmath>
#include <limits>

#include "core/friction/capture.hpp"

namespace stickslip::friction {

SlipModel::SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
                     const BeltCourse& belt) noexcept
    : shared_(shared),
      slip_(slip),
      belt_(&belt),
      waveform_{slip.K, slip.S - slip.K, belt.stick_rate(shared.r, slip.onset_s), shared.oscillator()},
      capture_s_(captured ? capture_time_s(waveform_, belt, shared.r, slip.onset_s)
                                .value_or(deciding_time_s(waveform_, belt, shared.r, slip.onset_s))
                          : std::numeric_limits<double>::infinity()) {}

SlipModelPoint SlipModel::slipping(double tau_s) const noexcept {
  // c = K + e^(−γτ/2) [D cos ωτ + B sin ωτ], B = (r + γD/2)/ω: (11) without a division by D.
  const double omega = shared_.omega;
  const double gamma = shared_.gamma;
  const double r = waveform_.r;
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
  if (!belt_->is_constant()) {
    // The slip begins at the belt's rate r p(onset).
    const double by_rate = point.by_shared[2];
    point.by_slip[0] += by_rate * shared_.r * belt_->slope(slip_.onset_s);
    point.by_shared[2] = by_rate * belt_->relative(slip_.onset_s);
  }
  return point;
}

SlipModelPoint SlipModel::at(double time_s) const noexcept {
  const double tau_s = time_s - slip_.onset_s;
  if (tau_s < 0.0) {
    SlipModelPoint point;
    point.value = slip_.S + belt_->climb(shared_.r, slip_.onset_s, tau_s);
    point.by_slip = {-waveform_.r, 1.0, 0.0};
    point.by_shared = {0.0, 0.0, belt_->way_s(slip_.onset_s, tau_s)};
    return point;
  }
  if (tau_s <= capture_s_) return slipping(tau_s);
  // c and c′ are continuous at the capture, so its shift drops out of the derivatives; the onset's moves the
  // slip along the time, on which the belt's speed depends.
  SlipModelPoint point = slipping(capture_s_);
  const double since_s = tau_s - capture_s_;
  const double capture_at_s = slip_.onset_s + capture_s_;
  const double onset_by_start = belt_->is_constant() ? 0.0 : point.by_slip[0] + waveform_.rate(capture_s_);
  point.value += belt_->climb(shared_.r, capture_at_s, since_s);
  point.by_slip[0] = onset_by_start - belt_->stick_rate(shared_.r, capture_at_s);
  point.by_shared[2] += belt_->way_s(capture_at_s, since_s);
  return point;
}

}  // namespace stickslip::friction
