/// \file
/// Limits for figures of a random sample, derived from its size. A right program is beyond a limit with
/// probability kFalseAlarm. Seeds of tests are fixed, so a test is drawn anew only where the code changes.
#pragma once

#include <cmath>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace stickslip::test {

/// Of one limit.
inline constexpr double kFalseAlarm = 1e-4;

/// Highest value of (mean of n squares of standard normal numbers); its root limits an rms.
inline double highest_mean_square(double n) {
  return boost::math::quantile(boost::math::complement(boost::math::chi_squared{n}, kFalseAlarm)) / n;
}

/// Lowest value of the same.
inline double lowest_mean_square(double n) {
  return boost::math::quantile(boost::math::chi_squared{n}, kFalseAlarm) / n;
}

/// Distance of a mean of n values from the truth, in sample standard deviations of one value; both sides.
inline double farthest_mean(double n) {
  return boost::math::quantile(boost::math::complement(boost::math::students_t{n - 1.0}, 0.5 * kFalseAlarm)) /
         std::sqrt(n);
}

/// Highest count among n if each counts with probability `share`, 0 < share < 1.
inline double highest_count(double n, double share) {
  return boost::math::quantile(boost::math::complement(boost::math::binomial{n, share}, kFalseAlarm));
}

/// Lowest count.
inline double lowest_count(double n, double share) {
  return boost::math::quantile(boost::math::binomial{n, share}, kFalseAlarm);
}

}  // namespace stickslip::test
