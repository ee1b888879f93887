/// \file
/// Root of a monotonically rising function in a bracket.
#pragma once

#include <cstdint>
#include <limits>

#include <boost/math/tools/toms748_solve.hpp>

namespace stickslip::sim {

/// Zero of a rising function between low and high, to the last bits of a double. [Algorithm 748: Alefeld,
/// Potra and Shi, ACM TOMS 21(3):327–344, 1995]
/// \param excess  rises monotonically from ≤ 0 at low to ≥ 0 at high, but for rounding.
/// \return low if excess(low) ≥ 0, else high if excess(high) ≤ 0, else the zero.
template <typename Function>
[[nodiscard]] double rise_between(const Function& excess, double low, double high) {
  using Quiet = boost::math::policies::policy<
      boost::math::policies::evaluation_error<boost::math::policies::ignore_error>,
      boost::math::policies::domain_error<boost::math::policies::ignore_error>>;
  const double at_low = excess(low);
  const double at_high = excess(high);
  if (at_low >= 0.0) return low;    // Only by rounding.
  if (at_high <= 0.0) return high;  // Grazing.
  std::uintmax_t iterations = 200;  // About ten are needed.
  const auto bracket = boost::math::tools::toms748_solve(
      excess, low, high, at_low, at_high,
      boost::math::tools::eps_tolerance<double>(std::numeric_limits<double>::digits - 1), iterations,
      Quiet());
  return bracket.first + (bracket.second - bracket.first) / 2.0;
}

}  // namespace stickslip::sim
