#include "core/model/slip_model.hpp"

#include <limits>

#include "core/model/capture.hpp"

namespace stickslip::model {

SlipModel::SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
                     const BeltCourse& belt) noexcept
    : shared_(shared),
      slip_(slip),
      belt_(&belt),
      waveform_{slip.K, slip.S - slip.K, belt.stick_rate(shared.r, slip.onset_s), shared.oscillator()},
      capture_s_(captured ? capture_time_s(waveform_, belt, shared.r, slip.onset_s)
                                .value_or(deciding_time_s(waveform_, belt, shared.r, slip.onset_s))
                          : std::numeric_limits<double>::infinity()) {
  if (!captured) return;
  at_capture_ = slipping(capture_s_);
  // c and c′ are continuous at the capture, so its shift drops out of the derivatives; the onset's moves the
  // slip along the time, on which the belt's speed depends.
  at_capture_.by_slip[0] = belt.is_constant() ? 0.0 : at_capture_.by_slip[0] + waveform_.rate(capture_s_);
}

SlipModelPoint SlipModel::slipping(double tau_s) const noexcept {
  // c = K + e^(−γτ/2) [D cos ωτ + B sin ωτ], B = (r + γD/2)/ω: (11) without a division by D.
  const DampedBasis basis = damped_basis(waveform_.oscillator, tau_s);
  const double omega = shared_.omega;
  const double gamma = shared_.gamma;
  const double r = waveform_.r;
  const double D = waveform_.D;
  const double omega_B = r + 0.5 * gamma * D;
  const double swing = D * basis.cosine + omega_B * basis.sine;
  const double by_D = basis.cosine + 0.5 * gamma * basis.sine;

  SlipModelPoint point;
  point.value = slip_.K + swing;
  point.by_slip = {-waveform_.rate(basis), by_D, 1.0 - by_D};
  point.by_shared = {
      tau_s * (omega_B / omega * basis.cosine - D * omega * basis.sine) - omega_B / omega * basis.sine,
      -0.5 * tau_s * swing + 0.5 * D * basis.sine, basis.sine};
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
  SlipModelPoint point = at_capture_;
  const double since_s = tau_s - capture_s_;
  const double capture_at_s = slip_.onset_s + capture_s_;
  point.value += belt_->climb(shared_.r, capture_at_s, since_s);
  point.by_slip[0] -= belt_->stick_rate(shared_.r, capture_at_s);
  point.by_shared[2] += belt_->way_s(capture_at_s, since_s);
  return point;
}

}  // namespace stickslip::model
