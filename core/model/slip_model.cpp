#include "core/model/slip_model.hpp"

#include <limits>

#include "core/model/capture.hpp"

namespace stickslip::model {

SlipModel::SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
                     const BeltCourse& belt, std::optional<double> expected_capture_s) noexcept
    : shared_(shared),
      slip_(slip),
      belt_(&belt),
      waveform_{slip.K, slip.S - slip.K, belt.stick_rate(shared.r, slip.onset_s), shared.oscillator()},
      capture_s_(captured ? capture_time(expected_capture_s) : std::numeric_limits<double>::infinity()) {
  if (!captured) return;
  at_capture_ = slipping(capture_s_, damped_basis(waveform_.oscillator, capture_s_));
  at_capture_.curvature = 0.0;
  // c and c′ are continuous at the capture, so its shift drops out of the derivatives; the onset's moves the
  // slip along the time, on which the belt's speed depends.
  at_capture_.by[0] = belt.is_constant() ? 0.0 : at_capture_.by[0] + waveform_.rate(capture_s_);
}

double SlipModel::capture_time(std::optional<double> expected_s) const noexcept {
  if (expected_s && belt_->is_constant()) {
    if (const auto near = capture_time_near_s(waveform_, shared_.r, *expected_s)) return *near;
  }
  const auto captured = capture_time_s(waveform_, *belt_, shared_.r, slip_.onset_s);
  return captured ? *captured : deciding_time_s(waveform_, *belt_, shared_.r, slip_.onset_s);
}

SlipModelPoint SlipModel::slipping(double tau_s, const DampedBasis& basis) const noexcept {
  // c = K + e^(−γτ/2) [D cos ωτ + B sin ωτ], B = (r + γD/2)/ω: (11) without a division by D.
  const double omega = shared_.omega;
  const double gamma = shared_.gamma;
  const double r = waveform_.r;
  const double D = waveform_.D;
  const double omega_B = r + 0.5 * gamma * D;
  const double B = omega_B / omega;
  const double swing = D * basis.cosine + omega_B * basis.sine;
  const double by_D = basis.cosine + 0.5 * gamma * basis.sine;
  const double rate = waveform_.rate(basis);

  SlipModelPoint point;
  point.value = slip_.K + swing;
  point.curvature = -gamma * rate - waveform_.oscillator.omega0_squared() * swing;
  point.by << -rate, by_D, 1.0 - by_D, tau_s * (B * basis.cosine - D * omega * basis.sine) - B * basis.sine,
      -0.5 * tau_s * swing + 0.5 * D * basis.sine, basis.sine;
  if (!belt_->is_constant()) {
    // The slip begins at the belt's rate r p(onset).
    const double by_rate = point.by[5];
    point.by[0] += by_rate * shared_.r * belt_->slope(slip_.onset_s);
    point.by[5] = by_rate * belt_->relative(slip_.onset_s);
  }
  return point;
}

SlipModelPoint SlipModel::sticking(double tau_s) const noexcept {
  if (tau_s < 0.0) {
    SlipModelPoint point;
    point.value = slip_.S + belt_->climb(shared_.r, slip_.onset_s, tau_s);
    point.by << -waveform_.r, 1.0, 0.0, 0.0, 0.0, belt_->way_s(slip_.onset_s, tau_s);
    return point;
  }
  SlipModelPoint point = at_capture_;
  const double since_s = tau_s - capture_s_;
  const double capture_at_s = slip_.onset_s + capture_s_;
  point.value += belt_->climb(shared_.r, capture_at_s, since_s);
  point.by[0] -= belt_->stick_rate(shared_.r, capture_at_s);
  point.by[5] += belt_->way_s(capture_at_s, since_s);
  return point;
}

}  // namespace stickslip::model
