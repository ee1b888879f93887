#include "core/estimate/shared_prior.hpp"

#include <Eigen/LU>

namespace stickslip::estimate {

PriorTerms SharedPrior::at(const model::SharedParameters& shared) const {
  PriorTerms terms;
  const auto& [omega, gamma, r] = shared;
  if (coupling) {
    const double ratio = gamma / (2.0 * omega);
    const Eigen::Vector2d off{coupling->omega - omega, coupling->gamma_over_2omega - ratio};
    const Eigen::Matrix2d weight = coupling->covariance.inverse();
    Eigen::Matrix<double, 2, 3> slope = Eigen::Matrix<double, 2, 3>::Zero();
    slope(0, 0) = 1.0;
    slope(1, 0) = -ratio / omega;
    slope(1, 1) = 1.0 / (2.0 * omega);
    terms.cost += 0.5 * off.dot(weight * off);
    terms.information += slope.transpose() * weight * slope;
    terms.gradient += slope.transpose() * (weight * off);
  }
  if (belt) {
    const double omega0_squared = omega * omega + 0.25 * gamma * gamma;
    const double speed = r / omega0_squared;
    const double off = belt->speed_over_gravity_s - speed;
    const double weight = 1.0 / (belt->standard_error_s * belt->standard_error_s);
    const Eigen::Vector3d slope{-2.0 * omega * speed / omega0_squared, -0.5 * gamma * speed / omega0_squared,
                                1.0 / omega0_squared};
    terms.cost += 0.5 * weight * off * off;
    terms.information += weight * slope * slope.transpose();
    terms.gradient += weight * off * slope;
  }
  return terms;
}

}  // namespace stickslip::estimate
