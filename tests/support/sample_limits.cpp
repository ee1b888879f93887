#include "tests/support/sample_limits.hpp"

#include <cmath>

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace stickslip::test {

using boost::math::complement;
using boost::math::quantile;

double highest_mean_square(double n, double false_alarm) {
  return quantile(complement(boost::math::chi_squared{n}, false_alarm)) / n;
}

double lowest_mean_square(double n, double false_alarm) {
  return quantile(boost::math::chi_squared{n}, false_alarm) / n;
}

double farthest_mean(double n) {
  return quantile(complement(boost::math::students_t{n - 1.0}, 0.5 * kFalseAlarm)) / std::sqrt(n);
}

double highest_count(double n, double share, double false_alarm) {
  return quantile(complement(boost::math::binomial{n, share}, false_alarm));
}

double lowest_count(double n, double share) { return quantile(boost::math::binomial{n, share}, kFalseAlarm); }

}  // namespace stickslip::test
