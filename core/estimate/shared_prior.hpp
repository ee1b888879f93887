/// \file
/// What is known of ω, γ and the stick rate before a test. It enters a fit as observations of its own,
/// beside the scans and with their own standard errors.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Normal equations of the prior, in the order (ω, γ, r).
struct PriorTerms {
  double cost = 0.0;  ///< Half the sum of squares over variances.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< Down the cost.
};

struct SharedPrior {
  /// From a characterisation of the tester: it belongs to the tester, not to the paper.
  struct Coupling {
    double omega = 0.0;  ///< rad/s, damped.
    double gamma_over_2omega = 0.0;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< Of these two; positive definite.
  };
  /// A pull speed that can be relied on.
  struct Belt {
    double speed_over_gravity_s = 0.0;  ///< v/g = r/ω₀²
    double standard_error_s = 0.0;      ///< > 0
  };

  std::optional<Coupling> coupling;
  std::optional<Belt> belt;

  [[nodiscard]] bool empty() const noexcept { return !coupling && !belt; }
  /// \param shared  where r/ω₀² and γ/2ω are made linear.
  [[nodiscard]] PriorTerms at(const model::SharedParameters& shared) const;
};

}  // namespace stickslip::estimate
