#include "core/sim/motion_contract.hpp"

#include <cmath>

#include "core/base/contract.hpp"

namespace stickslip::sim {
namespace {

void expect_sound(const BeltSegment& segment) {
  STICKSLIP_EXPECTS(segment.duration_s >= 0.0);
  STICKSLIP_EXPECTS(std::isfinite(segment.speed_m_per_s) && std::isfinite(segment.acceleration_m_per_s2));
  STICKSLIP_EXPECTS(std::isfinite(segment.jerk_m_per_s3) && std::isfinite(segment.decaying_speed_m_per_s));
  STICKSLIP_EXPECTS(segment.time_constant_s > 0.0);
}

}  // namespace

void expect_sound(const Motion& motion) {
  STICKSLIP_EXPECTS(motion.oscillator.gamma_per_s >= 0.0 && std::isfinite(motion.oscillator.gamma_per_s));
  STICKSLIP_EXPECTS(motion.oscillator.omega0_squared() > 0.0 &&
                    std::isfinite(motion.oscillator.omega0_squared()));
  STICKSLIP_EXPECTS(0.0 <= motion.mu_k && motion.mu_k <= motion.mu_s && std::isfinite(motion.mu_s));
  STICKSLIP_EXPECTS(motion.gravity_m_per_s2 > 0.0 && std::isfinite(motion.gravity_m_per_s2));
  STICKSLIP_EXPECTS(motion.startup_slack_m == 0.0 ||
                    (motion.startup_slack_m > 0.0 && motion.one_way_coupling));
  for (const BeltSegment& segment : motion.belt) expect_sound(segment);
  if (const auto& drift = motion.kinetic_drift) {
    STICKSLIP_EXPECTS(std::isfinite(drift->change) && drift->scale > 0.0);
  }
}

}  // namespace stickslip::sim
