#include "core/sim/first_slip.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/sim/motion_solver.hpp"

namespace stickslip::sim {

double first_slip_amplitude(const Scene& scene, std::uint64_t seed, double onset_s) {
  constexpr std::size_t kPoints = 2000;  // 1 − cos(π/2000) = 1.2e-6
  const double rate_Hz =
      static_cast<double>(kPoints) * scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  const auto motion = make_motion_solver(motion_of(scene), rate_Hz, scene.accuracy, nullptr, seed);
  motion->skip(static_cast<std::int64_t>(std::ceil(onset_s * rate_Hz)));
  std::vector<double> force(kPoints);
  motion->next(force);
  const auto [least, most] = std::minmax_element(force.begin(), force.end());
  return (*most - *least) / 2.0;
}

}  // namespace stickslip::sim
