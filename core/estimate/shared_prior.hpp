/// \file
/// Gaussian prior of ω, γ and the stick rate, from a characterisation of the tester and from the pull speed.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Terms of the prior in a fit's normal equations, in the order (ω, γ, r).
struct PriorTerms {
  double cost = 0.0;  ///< Half the sum of squares over variances; of SharedPosterior but for a constant.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< Negative gradient of the cost.
};

/// Gaussian prior of ω, γ and r; empty if nothing is known.
struct SharedPrior {
  /// Prior of ω and γ/2ω from a characterisation of the tester, or of a damping that is held.
  struct Coupling {
    double omega = 0.0;  ///< rad/s, damped.
    double gamma_over_2omega = 0.0;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< Of these two; positive definite.
  };
  /// Prior of r/ω₀² from a pull speed with known standard error.
  struct Belt {
    double speed_over_gravity_s = 0.0;  ///< v/g = r/ω₀²
    double standard_error_s = 0.0;      ///< > 0
  };

  std::optional<Coupling> coupling;
  std::optional<Belt> belt;

  [[nodiscard]] bool empty() const noexcept { return !coupling && !belt; }
  /// Terms for a fit's normal equations; zero if empty().
  /// \param shared  parameters about which r/ω₀² and γ/2ω are linearised.
  [[nodiscard]] PriorTerms at(const model::SharedParameters& shared) const;
};

}  // namespace stickslip::estimate
