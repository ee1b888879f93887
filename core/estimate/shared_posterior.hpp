/// \file
/// Running estimate of ω, γ and the stick rate during a test: the prior, updated by each cycle, with a fading
/// memory.
#pragma once

#include "core/estimate/shared_prior.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Gaussian likelihood of x = (ω, γ, r), in rad/s, 1/s and 1/s, from the scans of one cycle alone. Its cost
/// is ½ (x − x̂)ᵀ information (x − x̂).
struct SharedEvidence {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();  ///< information · x̂
};

/// Information filter with fading memory: 32 cycles count. The prior does not fade. start() must be called
/// before the others. Fixed size; does not allocate.
class SharedPosterior {
 public:
  explicit SharedPosterior(SharedPrior prior) : prior_(std::move(prior)) {}

  /// ω and γ come from a characterisation of the tester.
  [[nodiscard]] bool characterised() const noexcept { return prior_.coupling.has_value(); }

  /// Initial estimate from turning points and slopes; forgets what was learnt. A characterised ω and γ, and a
  /// stick rate known from the pull speed, take precedence; γ/2ω without a characterisation is
  /// model::kTypicalGammaOver2Omega.
  /// \param omega  rad/s, > 0. \param stick_rate_per_s > 0.
  void start(double omega, double stick_rate_per_s);
  /// Adds the information of one cycle and fades that of earlier ones and of start()'s first estimate.
  /// Ignores evidence that is not finite. best() stays as it is if the new one would not have ω > 0, r > 0
  /// and |γ| < 2ω.
  void learn(const SharedEvidence& evidence);
  /// Restarts the estimate of r after a change of the belt's speed. Keeps what was learnt of ω and γ, and the
  /// prior: one of the pull speed still holds r near the former speed.
  /// \param stick_rate_per_s  new first estimate, > 0.
  void forget_stick_rate(double stick_rate_per_s);

  /// Prior and learnt information as terms of a fit's normal equations, linearised about `shared`. The cost
  /// is known up to a constant and may be negative.
  [[nodiscard]] PriorTerms at(const model::SharedParameters& shared) const;
  /// Present estimate.
  [[nodiscard]] const model::SharedParameters& best() const noexcept { return best_; }

 private:
  void update_best();

  SharedPrior prior_;
  SharedEvidence learnt_;   ///< Information of the cycles, lasting_ included.
  SharedEvidence lasting_;  ///< Part of the initial information that does not fade.
  model::SharedParameters best_;
};

}  // namespace stickslip::estimate
