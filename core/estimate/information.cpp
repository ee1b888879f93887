#include "core/estimate/information.hpp"

#include <cmath>

#include <Eigen/LU>

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;

/// (ω, γ) → (ω, γ/2ω).
Eigen::Matrix2d to_ratio(const model::SharedParameters& shared) {
  Eigen::Matrix2d slope = Eigen::Matrix2d::Identity();
  slope(1, 0) = -shared.gamma / (2.0 * shared.omega * shared.omega);
  slope(1, 1) = 1.0 / (2.0 * shared.omega);
  return slope;
}

}  // namespace

P::Matrix fisher_information(const model::UniformTrajectory& course, std::span<const double> times_s,
                             double sigma) {
  P::Matrix information = P::Matrix::Zero();
  for (const double time_s : times_s) {
    const P::Vector by = course.at(time_s).by / sigma;
    information += by * by.transpose();
  }
  return information;
}

Eigen::Matrix2d ring_down_bound(const model::SharedParameters& shared, const model::SlipParameters& slip,
                                std::span<const double> times_s, double sigma) {
  const model::SlipModel model{shared, slip, false};
  P::Matrix information = P::Matrix::Zero();
  for (const double time_s : times_s) {
    const model::SlipModelPoint point = model.at(time_s);
    const P::Vector by = point.by / sigma;
    information += by * by.transpose();
  }
  const Eigen::Matrix2d coupling = P::Matrix{information.inverse()}.block<2, 2>(P::kOmega, P::kOmega);
  return to_ratio(shared) * coupling * to_ratio(shared).transpose();
}

UniformBounds cramer_rao_bounds(const P& parameters, const P::Matrix& information, const SharedPrior& prior) {
  P::Matrix all = information;
  all.bottomRightCorner<3, 3>() += prior.at(parameters.shared).information;
  const P::Matrix covariance = all.fullPivLu().inverse();
  const Eigen::Matrix2d coupling = to_ratio(parameters.shared) *
                                   covariance.block<2, 2>(P::kOmega, P::kOmega) *
                                   to_ratio(parameters.shared).transpose();
  const double S = covariance(P::kS, P::kS);
  const double K = covariance(P::kK, P::kK);
  return {std::sqrt(S), std::sqrt(K), std::sqrt(S + K - 2.0 * covariance(P::kS, P::kK)),
          std::sqrt(coupling(0, 0)), std::sqrt(coupling(1, 1))};
}

}  // namespace stickslip::estimate
