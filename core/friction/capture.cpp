#include "core/friction/capture.hpp"

#include <cstdint>
#include <numbers>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::friction {
namespace {

/// Root of a function with different signs at the ends. Algorithm 748 [Alefeld, Potra and Shi, ACM TOMS
/// 21(3):327–344, 1995] keeps the bracket.
template <typename Function>
double root_between(const Function& function, double low, double high, double at_low, double at_high) {
  std::uintmax_t iterations = 100;
  const auto bracket = boost::math::tools::toms748_solve(
      function, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(50), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

}  // namespace

std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept {
  const double t2 = slip.fastest_slip_time_s();
  const double t3 = slip.rise_end_time_s();
  const double rate_at_end = slip.rate(t3);
  if (!(rate_at_end >= belt_rate_per_s)) return std::nullopt;
  const double rate_at_begin = slip.rate(t2);
  if (rate_at_begin >= belt_rate_per_s) return t2;
  if (rate_at_end == belt_rate_per_s) return t3;
  return root_between([&](double t_s) { return slip.rate(t_s) - belt_rate_per_s; }, t2, t3,
                      rate_at_begin - belt_rate_per_s, rate_at_end - belt_rate_per_s);
}

double deciding_time_s(const SlipWaveform& slip, const BeltCourse& belt, double r, double onset_s) noexcept {
  const double t3 = slip.rise_end_time_s();
  if (belt.is_constant()) return t3;
  const auto excess_slope = [&](double t_s) {
    return slip.acceleration(t_s) - r * belt.slope(onset_s + t_s);
  };
  // c″ falls through zero at t₃, from its largest to its least value a quarter of an oscillation away.
  const double quarter_s = std::numbers::pi / 2.0 / slip.oscillator.omega_rad_per_s();
  const double before = excess_slope(t3 - quarter_s);
  const double after = excess_slope(t3 + quarter_s);
  if (!(before > 0.0 && after < 0.0)) return t3;
  return root_between(excess_slope, t3 - quarter_s, t3 + quarter_s, before, after);
}

std::optional<double> capture_time_s(const SlipWaveform& slip, const BeltCourse& belt, double r,
                                     double onset_s) noexcept {
  if (belt.is_constant()) return capture_time_s(slip, r);
  const auto excess = [&](double t_s) { return slip.rate(t_s) - belt.stick_rate(r, onset_s + t_s); };
  const double t2 = slip.fastest_slip_time_s();
  const double end = deciding_time_s(slip, belt, r, onset_s);
  const double at_end = excess(end);
  if (!(at_end >= 0.0)) return std::nullopt;
  const double at_begin = excess(t2);
  if (at_begin >= 0.0) return t2;
  if (at_end == 0.0) return end;
  return root_between(excess, t2, end, at_begin, at_end);
}

}  // namespace stickslip::friction
