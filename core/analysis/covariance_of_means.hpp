/// \file
/// Covariance of the means of S and K from their errors and that of their difference.
#pragma once

#include <Eigen/Core>

namespace stickslip::analysis {

/// Covariance of the means (S, K) such that Var(S − K) = of_difference². The error of S − K is the best
/// known, since S − K wanders less than S and K. No standard error of the three can exceed the sum of the
/// other two: that of S or K, if too large, is reduced to this sum; if that of S − K is too large, those of S
/// and K are scaled up.
/// \param of_S,of_K,of_difference  standard errors, ≥ 0.
/// \return positive semidefinite; zero if the errors of S and K are both zero.
[[nodiscard]] Eigen::Matrix2d covariance_of_means(double of_S, double of_K, double of_difference);

}  // namespace stickslip::analysis
