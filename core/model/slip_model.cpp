#include "core/model/slip_model.hpp"

#include <limits>

#include "core/model/capture.hpp"

namespace stickslip::model {

SlipModel::SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
                     const BeltMotion& belt, std::optional<double> expected_capture_s) noexcept
    : shared_(shared),
      slip_(slip),
      belt_(&belt),
      waveform_{slip.K, slip.S - slip.K, belt.stick_rate(shared.r, slip.onset_s), shared.oscillator()},
      omega_B_(waveform_.r + 0.5 * shared.gamma * waveform_.D),
      capture_s_(captured ? capture_time(expected_capture_s) : std::numeric_limits<double>::infinity()) {
  set_slip_coefficients();
  before_ << -waveform_.r, 1.0, 0.0, 0.0, 0.0, 0.0;
  if (!captured) return;
  const SlipPlace capture = slip_place(capture_s_, damped_basis(waveform_.oscillator, capture_s_));
  at_capture_ = capture.value;
  after_.noalias() = by_slip_terms_ * slip_terms(capture);
  // c and c′ are continuous at the capture, so its shift drops out of the derivatives; the onset's moves the
  // slip along the time, on which the belt's speed depends.
  after_[0] = belt.is_constant() ? 0.0 : after_[0] + waveform_.rate(capture.basis);
  after_[0] -= belt.stick_rate(shared.r, slip.onset_s + capture_s_);
}

double SlipModel::capture_time(std::optional<double> expected_s) const noexcept {
  if (expected_s && belt_->is_constant()) {
    if (const auto near = capture_time_near_s(waveform_, shared_.r, *expected_s)) return *near;
  }
  const auto captured = capture_time_s(waveform_, *belt_, shared_.r, slip_.onset_s);
  return captured ? *captured : deciding_time_s(waveform_, *belt_, shared_.r, slip_.onset_s);
}

void SlipModel::set_slip_coefficients() noexcept {
  const double omega = shared_.omega;
  const double gamma = shared_.gamma;
  const double r = waveform_.r;
  const double D = waveform_.D;
  const double B = omega_B_ / omega;
  // Columns: 1, cosine, sine, τ cosine, τ sine, where sine is that of DampedBasis, over ω.
  SlipCoefficients& by = by_slip_terms_;
  by(0, 1) = -r;
  by(0, 2) = 0.5 * gamma * r + waveform_.oscillator.omega0_squared() * D;
  by(1, 1) = 1.0;
  by(1, 2) = 0.5 * gamma;
  by(2, 0) = 1.0;
  by(2, 1) = -1.0;
  by(2, 2) = -0.5 * gamma;
  by(3, 2) = -B;
  by(3, 3) = B;
  by(3, 4) = -D * omega;
  by(4, 2) = 0.5 * D;
  by(4, 3) = -0.5 * D;
  by(4, 4) = -0.5 * omega_B_;
  by(5, 2) = 1.0;
  if (belt_->is_constant()) return;
  // The slip begins at the belt's rate r p(onset).
  by(0, 2) += shared_.r * belt_->slope(slip_.onset_s);
  by(5, 2) = belt_->relative(slip_.onset_s);
}

SlipModelPoint SlipModel::point_at(const SlipPlace& place) const noexcept {
  SlipModelPoint point;
  point.value = place.value;
  point.curvature = curvature(place);
  if (place.phase == SlipPhase::kSlip) {
    point.by.noalias() = by_slip_terms_ * slip_terms(place);
  } else {
    point.by = stick_begin(place.phase);
    point.by[5] += place.way_s;
  }
  return point;
}

}  // namespace stickslip::model
