/// \file
/// Covariance of the means of S and K from their errors and that of their difference.
#pragma once

#include <Eigen/Core>

namespace stickslip::analysis {

/// Covariance of (S, K) with Var(S − K) = of_difference²: the error of S − K is known best, as it wanders
/// less than S and K. No standard error of the three can exceed the sum of the others. That of S or of K is
/// reduced to this sum, since it is a guess where the level wanders slowly; if that of S − K exceeds it,
/// those of S and K are scaled up.
/// \param of_S,of_K,of_difference  standard errors, ≥ 0.
/// \return positive semidefinite; zero if the errors of S and K are both zero.
[[nodiscard]] Eigen::Matrix2d covariance_of_means(double of_S, double of_K, double of_difference);

}  // namespace stickslip::analysis
