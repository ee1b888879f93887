/// \file
/// Covariance of the means of S and K from their errors and that of their difference.
#pragma once

#include <Eigen/Core>

namespace stickslip::analysis {

/// The error of S − K is known best, as it wanders less than S and K: with theirs it tells the covariance of
/// the two. Of three errors none exceeds the sum of the others. Where that of S or K does, as each wanders so
/// slowly that its own is guessed, it is less; where that of S − K does, those of S and K are more.
/// \param of_S,of_K,of_difference  standard errors, ≥ 0. \return of (S, K), positive semidefinite; the error
/// of S − K by it is of_difference.
[[nodiscard]] Eigen::Matrix2d covariance_of_means(double of_S, double of_K, double of_difference);

}  // namespace stickslip::analysis
