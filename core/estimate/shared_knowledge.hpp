/// \file
/// What is known of ω, γ and the stick rate while a test runs: what was known before it, and what its cycles
/// so far have told, of which the older counts less.
#pragma once

#include "core/estimate/shared_prior.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// What the scans of one cycle alone say about (ω, γ, r): half of (x − x̂)ᵀ information (x − x̂) is their cost.
struct SharedEvidence {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();  ///< information · x̂
};

/// Information filter with a fading memory. Fixed size; does not allocate.
class SharedKnowledge {
 public:
  explicit SharedKnowledge(SharedPrior prior) : prior_(std::move(prior)) {}

  /// ω and γ are measured beforehand.
  [[nodiscard]] bool characterised() const noexcept { return prior_.coupling.has_value(); }

  /// From turning points and slopes; ω and γ only count if they were not known before.
  void start(double omega, double stick_rate_per_s);
  void learn(const SharedEvidence& evidence);
  /// The belt has another speed now: what was learnt of r does not hold.
  void forget_stick_rate(double stick_rate_per_s);

  /// All that is known, as observations beside the scans; linear about `shared`.
  [[nodiscard]] PriorTerms at(const model::SharedParameters& shared) const;
  /// Best values so far.
  [[nodiscard]] const model::SharedParameters& best() const noexcept { return best_; }

 private:
  void update_best();

  SharedPrior prior_;
  SharedEvidence learnt_;   ///< lasting_ is part of it.
  SharedEvidence lasting_;  ///< Of the first knowledge, what does not fade.
  model::SharedParameters best_;
};

}  // namespace stickslip::estimate
