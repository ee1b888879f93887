#include "core/friction/capture.hpp"

#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::friction {

std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept {
  const double t2 = slip.fastest_slip_time_s();
  const double t3 = slip.rise_end_time_s();
  const double rate_at_end = slip.rate(t3);
  if (!(rate_at_end >= belt_rate_per_s)) return std::nullopt;
  const double rate_at_begin = slip.rate(t2);
  if (rate_at_begin >= belt_rate_per_s) return t2;
  if (rate_at_end == belt_rate_per_s) return t3;
  // Algorithm 748 [Alefeld, Potra and Shi, ACM TOMS 21(3):327–344, 1995] keeps the bracket.
  std::uintmax_t iterations = 100;
  const auto [low, high] = boost::math::tools::toms748_solve(
      [&](double t_s) { return slip.rate(t_s) - belt_rate_per_s; }, t2, t3, rate_at_begin - belt_rate_per_s,
      rate_at_end - belt_rate_per_s, boost::math::tools::eps_tolerance<double>(50), iterations);
  return 0.5 * (low + high);
}

}  // namespace stickslip::friction
