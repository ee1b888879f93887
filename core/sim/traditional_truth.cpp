#include "core/sim/traditional_truth.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/sim/motion_solver.hpp"

namespace stickslip::sim {
namespace {

/// Points in each free period. The largest of them is below a maximum by at most
/// 1 − cos(π/2000) = 1.2e-6 of the amplitude, and the mean is as close.
constexpr double kPointsPerPeriod = 2000.0;

}  // namespace

TraditionalTruth traditional_truth(const Scene& scene, std::uint64_t seed, double onset_s,
                                   const friction::Method& method) {
  TraditionalTruth truth;
  const double rate_Hz = kPointsPerPeriod * scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  const auto from = static_cast<std::int64_t>(std::floor(onset_s * rate_Hz));
  const auto end = static_cast<std::int64_t>(std::ceil(pull_of(scene)->end_s * rate_Hz));
  const auto motion = make_motion_solver(motion_of(scene), rate_Hz, scene.accuracy, nullptr, seed);
  motion->skip(from);

  std::array<double, 256> force{};
  double before = 0.0;
  double last = 0.0;
  double mean = 0.0;
  double count = 0.0;
  int maxima = 0;
  std::int64_t seen = 0;
  for (std::int64_t at = from; at < end; at += static_cast<std::int64_t>(force.size())) {
    motion->next(force);
    for (const double now : force) {
      if (++seen > 2 && last > before && last >= now) {
        if (++maxima == 1) truth.static_coefficient = last;
        if (maxima == method.kinetic_cycles + 1) {
          truth.kinetic_coefficient = mean;
          return truth;
        }
      }
      if (maxima > 0) mean += (last - mean) / ++count;
      before = last;
      last = now;
    }
  }
  return truth;
}

}  // namespace stickslip::sim
