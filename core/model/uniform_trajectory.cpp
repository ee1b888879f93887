#include "core/model/uniform_trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/capture.hpp"

namespace stickslip::model {

std::optional<UniformTrajectory> UniformTrajectory::make(const UniformParameters& parameters) {
  const auto& [shared, slip] = parameters;
  const bool sound = std::isfinite(slip.onset_s) && std::isfinite(shared.omega) && shared.omega > 0.0 &&
                     std::abs(shared.gamma) < 2.0 * shared.omega && shared.r > 0.0 && slip.S > slip.K;
  if (!sound) return std::nullopt;
  const SlipWaveform waveform{slip.K, slip.S - slip.K, shared.r, shared.oscillator()};
  if (!capture_time_s(waveform, shared.r)) return std::nullopt;
  return UniformTrajectory{parameters};
}

UniformTrajectory::UniformTrajectory(const UniformParameters& parameters)
    : onset_s_(parameters.slip.onset_s), slip_(parameters.shared, parameters.slip, true) {
  const double r = parameters.shared.r;
  const SlipModelPoint capture = slip_.at(onset_s_ + slip_.capture_s());
  const double stick_s = (parameters.slip.S - capture.value) / r;
  period_s_ = slip_.capture_s() + stick_s;
  period_by_ << 0.0, 1.0 - capture.by[1], -capture.by[2], -capture.by_shared();
  period_by_[UniformParameters::kR] -= stick_s;
  period_by_ /= r;
}

UniformTrajectory::Cycle UniformTrajectory::cycle_at(double time_s) const noexcept {
  // A cycle reaches from the capture before its onset to its own capture: both formulas agree there.
  const double first_end_s = onset_s_ + slip_.capture_s();
  const double number = std::max(std::floor((time_s - first_end_s) / period_s_) + 1.0, 0.0);
  // Rounding must not end it before this time.
  const double end_s = std::max(first_end_s + number * period_s_, std::nextafter(time_s, kForEver));
  return {number, number * period_s_, end_s};
}

UniformPoint UniformTrajectory::at(double time_s) const noexcept {
  const Cycle cycle = cycle_at(time_s);
  const SlipModelPoint point = slip_.at(time_s - cycle.after_first_s);
  return {point.value, point.by + point.by[0] * cycle.number * period_by_};
}

}  // namespace stickslip::model
