#include "core/sim/motion_solver.hpp"

#include <cmath>

#include "core/base/contract.hpp"
#include "core/sim/belt.hpp"
#include "core/sim/numeric_solver.hpp"
#include "core/sim/propagator.hpp"

namespace stickslip::sim {

namespace {

/// Smallest distance from resonance for closed forms. Near resonance a decay's response and the oscillation
/// are large and cancel; at this distance three of sixteen digits are lost.
constexpr double kNearestResonance = 1e-3;

bool responds_regularly(double rate_per_s, const model::Oscillator& oscillator) {
  return std::abs(distance_from_resonance(rate_per_s, oscillator)) >= kNearestResonance;
}

bool has_closed_form(const KineticDrift& drift, const Motion& motion) {
  const bool exponential = drift.form == KineticDrift::Form::kExponential;
  if (drift.over == KineticDrift::Over::kTime)
    return !exponential || responds_regularly(1.0 / drift.scale, motion.oscillator);
  for (const BeltSegment& segment : motion.belt) {
    if (exponential) {
      if (!belt_speed(segment).is_constant()) return false;
      if (!responds_regularly(segment.speed_m_per_s / drift.scale, motion.oscillator)) return false;
    } else if (segment.decaying_speed_m_per_s != 0.0 &&
               !responds_regularly(1.0 / segment.time_constant_s, motion.oscillator)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool has_closed_form(const Motion& motion) noexcept {
  if (motion.velocity_dependence || motion.rate_and_state) return false;
  return !motion.kinetic_drift || has_closed_form(*motion.kinetic_drift, motion);
}

std::unique_ptr<MotionSolver> make_motion_solver(const Motion& motion, double scan_rate_Hz, double accuracy,
                                                 MotionObserver* observer, std::uint64_t seed) {
  STICKSLIP_EXPECTS(accuracy > 0.0);
  if (!has_closed_form(motion)) {
    return std::make_unique<NumericSolver>(motion, scan_rate_Hz, accuracy, observer, seed);
  }
  return std::make_unique<Propagator>(motion, scan_rate_Hz, observer, seed);
}

}  // namespace stickslip::sim
