/// \file
/// Huber's robust loss and weights, and the covariance of estimates made with them. [Huber, Ann. Math. Stat.
/// 35:73–101, 1964; Robust Statistics, 1981]
#pragma once

#include <algorithm>
#include <cmath>

namespace stickslip::estimate {

/// Huber's limit k for estimates, in standard deviations: 95 % efficiency for Gaussian noise.
inline constexpr double kHuberLimit = 1.345;

/// HuberSums::residual_sigma() of Gaussian noise: √(E ψ(z) z/E w(z)) with E ψ(z) z = P(|z| ≤ k) = 0.8214 and
/// E w(z) = 0.8214 + k E₁(k²/2)/√(2π) = 0.9599.
inline constexpr double kHuberResidualOfNoise = 0.925;

/// Residual, in standard deviations, beyond which a scan is a missed spike: Gaussian noise exceeds it once in
/// two million scans.
inline constexpr double kStraySigmas = 5.0;

/// ρ(z): quadratic within the limit, linear outside.
[[nodiscard]] inline double huber_cost(double z, double limit = kHuberLimit) noexcept {
  const double size = std::abs(z);
  return size <= limit ? 0.5 * z * z : limit * (size - 0.5 * limit);
}

/// ψ(z)/z: the weight of a residual in the normal equations.
[[nodiscard]] inline double huber_weight(double z, double limit = kHuberLimit) noexcept {
  const double size = std::abs(z);
  return size <= limit ? 1.0 : limit / size;
}

/// Sums over the residuals of a fit, each in units of σ.
class HuberSums {
 public:
  /// \return the weight of this residual in the normal equations: ψ(z)/z.
  double add(double z) noexcept {
    const double weight = huber_weight(z);
    cost_ += huber_cost(z);
    square_sum_ += weight * z * z;
    weight_sum_ += weight;
    psi_square_sum_ += weight * weight * z * z;
    count_ += 1.0;
    if (weight == 1.0) inlier_count_ += 1.0;
    return weight;
  }

  [[nodiscard]] double cost() const noexcept { return cost_; }    ///< Σρ
  [[nodiscard]] double count() const noexcept { return count_; }  ///< Residuals.

  /// Weighted degrees of freedom: sum of weights less the number of parameters. If not positive, the standard
  /// errors are undefined.
  [[nodiscard]] double freedom(double parameters) const noexcept { return weight_sum_ - parameters; }

  /// Robust standard deviation of the residuals in σ, √(Σ w z²/freedom): kHuberResidualOfNoise, not 1, for
  /// Gaussian noise of standard deviation σ. 0 without freedom.
  [[nodiscard]] double residual_sigma(double parameters) const noexcept {
    return freedom(parameters) > 0.0 ? std::sqrt(square_sum_ / freedom(parameters)) : 0.0;
  }

  /// Scale of the cost, Σψ²/(n − p)/mean ψ′: twice a difference of costs divided by it is distributed as χ²,
  /// like twice a log-likelihood ratio of Gaussian noise [Hampel et al., Robust Statistics, 1986, section
  /// 7.2]; 0 if there are no more residuals than parameters.
  [[nodiscard]] double cost_scale(double parameters) const noexcept {
    const double left = count_ - parameters;
    return left > 0.0 ? psi_square_sum_ / left / inlier_part() : 0.0;
  }

  /// Factor by which (Σ w J Jᵀ)⁻¹ becomes the covariance, in σ²; 0 if there are no more residuals than
  /// parameters. The covariance is κ² · Σψ²/(n − p)/(mean ψ′)² · (JᵀJ)⁻¹, where the weighted sum is smaller
  /// by the mean weight. κ = 1 + (p/n)(1 − mean ψ′)/mean ψ′ is the correction for few residuals to each
  /// parameter [Huber 1981, (7.6.12)]: 1.8 % of a standard error at n/p = 12. The covariance of weighted
  /// least squares would be 15 % too small, since it ignores that the weights depend on the noise.
  [[nodiscard]] double covariance_scale(double parameters) const noexcept {
    if (!(count_ > parameters)) return 0.0;
    const double inliers = inlier_part();
    const double kappa = 1.0 + parameters / count_ * (1.0 - inliers) / inliers;
    return kappa * kappa * cost_scale(parameters) * (weight_sum_ / count_) / inliers;
  }

 private:
  /// mean ψ′.
  [[nodiscard]] double inlier_part() const noexcept {
    return std::max(inlier_count_, 1.0) / std::max(count_, 1.0);
  }

  double cost_ = 0.0;
  double square_sum_ = 0.0;      ///< Σ w z²
  double weight_sum_ = 0.0;      ///< Σ w
  double psi_square_sum_ = 0.0;  ///< Σ ψ²
  double inlier_count_ = 0.0;    ///< Residuals within the limit.
  double count_ = 0.0;
};

}  // namespace stickslip::estimate
