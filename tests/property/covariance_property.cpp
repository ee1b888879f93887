#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/analysis/covariance_of_means.hpp"

namespace stickslip::analysis {
namespace {

/// 0, or over eight decades.
double error() {
  const int decades_in_hundredths = *rc::gen::inRange(-601, 201);
  return decades_in_hundredths == -601 ? 0.0 : std::pow(10.0, decades_in_hundredths / 100.0);
}

RC_GTEST_PROP(CovarianceOfMeans, GivesTheDifferenceItsErrorAndKeepsThoseThatObey, ()) {
  const double of_S = error();
  const double of_K = error();
  // Not where both are known exactly and their difference is not: there is no such covariance.
  const double of_difference = of_S + of_K > 0.0 ? error() : 0.0;
  const Eigen::Matrix2d found = covariance_of_means(of_S, of_K, of_difference);
  const double largest = std::max({of_S, of_K, of_difference});
  const double rounding = 1e-14 * largest * largest;
  const double variance = found(0, 0) + found(1, 1) - 2.0 * found(0, 1);
  RC_ASSERT(std::abs(variance - of_difference * of_difference) <= 4.0 * rounding);
  RC_ASSERT(found(0, 1) == found(1, 0));
  const double determinant = found(0, 0) * found(1, 1) - found(0, 1) * found(1, 0);
  RC_ASSERT(determinant >= -4.0 * rounding * largest * largest);
  const double S = std::sqrt(found(0, 0));
  const double K = std::sqrt(found(1, 1));
  const double sum = of_S + of_K + of_difference;
  if (2.0 * largest <= sum) {
    RC_ASSERT(std::abs(S - of_S) <= 1e-14 * largest);
    RC_ASSERT(std::abs(K - of_K) <= 1e-14 * largest);
  } else if (of_difference == largest) {
    RC_ASSERT(S >= of_S * (1.0 - 1e-14));
    RC_ASSERT(K >= of_K * (1.0 - 1e-14));
  } else {
    RC_ASSERT(std::abs(std::min(S, K) - std::min(of_S, of_K)) <= 1e-14 * largest);
    RC_ASSERT(std::max(S, K) < largest);
  }
}

}  // namespace
}  // namespace stickslip::analysis
