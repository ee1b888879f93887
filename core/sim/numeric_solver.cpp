#include "core/sim/numeric_solver.hpp"

#include <cmath>

#include "core/base/contract.hpp"
#include "core/sim/motion_contract.hpp"

namespace stickslip::sim {
namespace {

std::unique_ptr<NumericMotion> make_motion(const Motion& motion, double scan_rate_Hz, double accuracy,
                                           MotionObserver* observer) {
  STICKSLIP_EXPECTS(scan_rate_Hz > 0.0 && accuracy > 0.0);
  expect_sound(motion);
  return motion.rate_and_state ? make_rate_and_state_motion(motion, scan_rate_Hz, accuracy, observer)
                               : make_sliding_motion(motion, scan_rate_Hz, accuracy, observer);
}

/// The cubic of both ends' values and rates misses by c⁗ h⁴/384, with |c⁗| ≤ ω₀⁴ for oscillations of
/// amplitude one.
double follow_step(const Motion& motion, double accuracy) {
  return std::pow(384.0 * accuracy, 0.25) / std::sqrt(motion.oscillator.omega0_squared());
}

/// [Hermite interpolation]
ForceStretch cubic(const SpringForce& from, const SpringForce& to, double duration_s) {
  ForceStretch stretch;
  stretch.duration_s = duration_s;
  const double chord = (to.c - from.c) / duration_s;
  stretch.course.add_power(0, from.c);
  stretch.course.add_power(1, from.rate_per_s);
  stretch.course.add_power(2, (3.0 * chord - 2.0 * from.rate_per_s - to.rate_per_s) / duration_s);
  stretch.course.add_power(3, (from.rate_per_s + to.rate_per_s - 2.0 * chord) / (duration_s * duration_s));
  return stretch;
}

}  // namespace

NumericSolver::NumericSolver(const Motion& motion, double scan_rate_Hz, double accuracy,
                             MotionObserver* observer, std::uint64_t seed)
    : motion_(make_motion(motion, scan_rate_Hz, accuracy, observer)),
      scan_rate_Hz_(scan_rate_Hz),
      // A motion without end has no finite accuracy.
      follow_step_s_(follow_step(
          motion, std::isfinite(motion_->method().accuracy) ? motion_->method().accuracy : accuracy)) {
  restart(seed);
}

void NumericSolver::restart(std::uint64_t seed) {
  next_scan_ = 0;
  followed_to_ = {};
  motion_->restart(seed);
}

void NumericSolver::pass_until(const ScanTime& instant) {
  while (motion_->known_to() <= instant && motion_->known_to() < kForEver) motion_->advance();
}

void NumericSolver::next(std::span<double> coefficient) {
  for (double& c : coefficient) {
    const ScanTime instant{next_scan_++, 0.0};
    pass_until(instant);
    c = motion_->force_at(instant).c;
  }
}

double NumericSolver::at(const ScanTime& instant) {
  pass_until(instant);
  return motion_->force_at(instant).c;
}

void NumericSolver::skip(std::int64_t scans) {
  next_scan_ += scans;
  pass_until({next_scan_, 0.0});
}

void NumericSolver::follow_to(const ScanTime& instant, ForceFollower& follower) {
  STICKSLIP_EXPECTS(motion_->known_from() <= followed_to_ && followed_to_ <= instant);
  while (true) {
    const bool ends = motion_->known_to() <= instant && motion_->known_to() < kForEver;
    const ScanTime to = ends ? motion_->known_to() : instant;
    while (followed_to_ < to) {
      const ScanTime next = std::min(to, followed_to_.later(follow_step_s_ * scan_rate_Hz_));
      follower.follow(cubic(motion_->force_at(followed_to_), motion_->force_at(next),
                            next.periods_since(followed_to_) / scan_rate_Hz_));
      followed_to_ = next;
    }
    if (!ends) return;
    motion_->advance();
  }
}

}  // namespace stickslip::sim
