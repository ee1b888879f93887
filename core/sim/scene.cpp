#include "core/sim/scene.hpp"

#include <cmath>

namespace stickslip::sim {

Motion motion_of(const Scene& scene) {
  Motion motion;
  motion.oscillator = scene.oscillator;
  motion.mu_s = scene.mu_s;
  motion.mu_k = scene.mu_k;
  motion.gravity_m_per_s2 = scene.gravity_m_per_s2;
  motion.paper = scene.paper;
  motion.damper_counts_at_onset = scene.onset_convention == OnsetConvention::kSpringAndDamper;
  motion.one_way_coupling = scene.one_way_coupling;
  if (scene.constant_speed) {
    const ConstantSpeed& test = *scene.constant_speed;
    motion.belt = {{test.idle_s, 0.0, false},
                   {test.pull_s, test.pull_speed_m_per_s, false},
                   {test.stop_s, 0.0, false},
                   {test.return_s, -test.return_speed_m_per_s, true}};
  }
  return motion;
}

double true_scan_rate_Hz(const Scene& scene, double scan_rate_Hz) noexcept {
  return scene.clock_rate_error ? scan_rate_Hz * (1.0 + scene.clock_rate_error->relative) : scan_rate_Hz;
}

std::int64_t scan_count(const Scene& scene, double scan_rate_Hz) noexcept {
  return static_cast<std::int64_t>(std::ceil(scene.duration_s * true_scan_rate_Hz(scene, scan_rate_Hz)));
}

}  // namespace stickslip::sim
