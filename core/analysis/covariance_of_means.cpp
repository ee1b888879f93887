#include "core/analysis/covariance_of_means.hpp"

#include <algorithm>

namespace stickslip::analysis {

Eigen::Matrix2d covariance_of_means(double of_S, double of_K, double of_difference) {
  double S = std::min(of_S, of_K + of_difference);
  double K = std::min(of_K, of_S + of_difference);
  if (const double sum = S + K; sum > 0.0 && of_difference > sum) {
    S *= of_difference / sum;
    K *= of_difference / sum;
  }
  // Rounding alone leads out of these.
  const double most = S * K;
  const double both = std::clamp(0.5 * (S * S + K * K - of_difference * of_difference), -most, most);
  return (Eigen::Matrix2d{} << S * S, both, both, K * K).finished();
}

}  // namespace stickslip::analysis
