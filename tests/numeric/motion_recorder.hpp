/// \file
/// Runs a motion and keeps what happened, in seconds.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/sim/propagator.hpp"

namespace stickslip::numeric {

inline constexpr double kOmega = 2.0 * std::numbers::pi * 20.0;
inline constexpr double kGravity = 9.80665;

/// S 0.35, K 0.30, belt at the speed that gives this Q.
inline sim::Motion motion_at(double Q, double gamma_over_2omega, double mu_s = 0.35, double mu_k = 0.30) {
  sim::Motion motion;
  motion.oscillator = model::Oscillator::from_omega(kOmega, gamma_over_2omega);
  motion.mu_s = mu_s;
  motion.mu_k = mu_k;
  motion.gravity_m_per_s2 = kGravity;
  const double speed = Q * kOmega * (mu_s - mu_k) * kGravity / motion.oscillator.omega0_squared();
  motion.belt = {{1e12, speed, false}};
  return motion;
}

/// At Q = 1's S and K, on a belt of these segments.
inline sim::Motion on_belt(std::vector<sim::BeltSegment> belt, double damping = 0.022, bool one_way = false) {
  sim::Motion motion = motion_at(1.0, damping);
  motion.belt = std::move(belt);
  motion.one_way_coupling = one_way;
  return motion;
}

class MotionRecorder final : public sim::MotionObserver {
 public:
  explicit MotionRecorder(double scan_rate_Hz) : scan_rate_Hz_(scan_rate_Hz) {}

  void mode_began(const sim::ModeStart& start) override {
    const double now_s = start.time.periods_since({}) / scan_rate_Hz_;
    starts.push_back(start);
    if (start.onset) onsets_s.push_back(now_s);
    if (start.capture) captures_s.push_back(now_s);
  }

  std::vector<sim::ModeStart> starts;
  std::vector<double> onsets_s;
  /// The first is the sled's catching up with the belt that has just started.
  std::vector<double> captures_s;

 private:
  double scan_rate_Hz_;
};

inline std::vector<double> trace(const sim::Motion& motion, double scan_rate_Hz, std::size_t count) {
  sim::Propagator sled{motion, scan_rate_Hz};
  std::vector<double> coefficient(count);
  sled.next(coefficient);
  return coefficient;
}

}  // namespace stickslip::numeric
