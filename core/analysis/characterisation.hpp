/// \file
/// Characterisation of a tester: ω and γ, which belong to the tester and not to the paper, pooled from
/// ring-downs. Each later test is checked against them, and its pull speed against the plan.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/analysis/results.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

/// Estimate of the tester's parameters from one test, or of a load cell's from one tap: then v/g is 0.
struct TesterEstimate {
  double omega = 0.0;  ///< rad/s, damped.
  double gamma_over_2omega = 0.0;
  double speed_over_gravity_s = 0.0;                     ///< v/g = r/ω₀²; v is the largest belt speed.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< Of the three above, in their order.

  /// Converts the parameters of a fit. The covariance is propagated to first order.
  /// \param covariance  of (ω, γ, r).
  [[nodiscard]] static TesterEstimate from(const model::SharedParameters& shared,
                                           const Eigen::Matrix3d& covariance);
};

/// Pooled ω and γ/2ω with the test of their agreement.
struct Characterisation {
  estimate::SharedPrior::Coupling coupling;  ///< Covariance scaled by χ²/freedom where that exceeds 1.
  int ring_downs = 0;
  double chi_squared = 0.0;  ///< Of the ring-downs about their mean.
  int freedom = 0;           ///< 2 (ring_downs − 1)

  /// Probability of a χ² at least this large if the ring-downs have equal parameters; 1 for a single one.
  [[nodiscard]] double probability() const;
};

/// TesterCheck::probability below which a test is reported as disagreeing with the characterisation. Every
/// test is checked: at 1e-4 a season of tests of a sound tester causes hardly one false report, while a
/// changed spring is off by many standard errors. Ring-downs disagree if Characterisation::probability() is
/// below it.
inline constexpr double kDisagreement = 1e-4;
/// TesterCheck::probability below which the characterisation is not used for a test. Without it γ from ten
/// cycles has a standard error 28 times larger, so a false rejection costs much. At 1e-4 false rejections
/// raised the rms error of γ to 1.8 times the Cramér–Rao bound; at 1e-7 they add 0.1 %.
inline constexpr double kNotThisTester = 1e-7;

/// Mean of the ring-downs, weighted by their inverse covariances. If χ² exceeds its degrees of freedom, the
/// covariance is multiplied by their ratio [Birge, Phys. Rev. 40:207–227, 1932].
/// \return nullopt if there is no ring-down or a covariance is singular.
[[nodiscard]] std::optional<Characterisation> pool_ring_downs(std::span<const TesterEstimate> ring_downs);

/// Relative deviation of the measured from the planned speed up to which nothing is reported: belts hold
/// their speed to 5 %.
inline constexpr double kSpeedTolerance = 0.05;

/// Check of one test against the characterisation and the planned speed.
struct TesterCheck {
  double chi_squared = 0.0;  ///< Of the test alone against the characterisation; 2 degrees of freedom.
  double probability = 1.0;  ///< Of a χ² at least this large by chance; 0 if χ² is not finite.
  Estimate pull_speed;       ///< m/s, by pull_speed_of(): lacks the part of a subtracted drift.
  std::vector<base::Finding> findings;  ///< kTesterChanged and kPullSpeed, if they apply.

  [[nodiscard]] bool agrees() const noexcept { return probability >= kDisagreement; }
  /// The characterisation may be used for this test.
  [[nodiscard]] bool used() const noexcept { return probability >= kNotThisTester; }
};

/// Pull speed v = (v/g) g, m/s, with its standard error. If a drift was subtracted from the trace, v lacks
/// drift rate · g/ω₀².
[[nodiscard]] Estimate pull_speed_of(const TesterEstimate& estimate, double gravity_m_per_s2);

/// Finding kPullSpeed if the measured speed differs from the planned one by more than kSpeedTolerance and by
/// more than three standard errors; else nullopt. Nullopt also if the plan, the measured speed or its
/// standard error is unknown.
[[nodiscard]] std::optional<base::Finding> speed_finding(const Estimate& measured_m_per_s,
                                                         const model::Tester& tester);

/// Slope μ′ = (γ − γ_known)/g of the kinetic coefficient with speed, s/m, with its standard error. It is the
/// slope less that of the paper on which the tester was characterised. A slope leaves S, K and S − K at the
/// pull speed as they are and adds g μ′ to the damping.
[[nodiscard]] Estimate slope_of_friction(const TesterEstimate& found,
                                         const estimate::SharedPrior::Coupling& known,
                                         double gravity_m_per_s2);

/// Probability that independent estimates of one number differ at least as much as these (χ² about their
/// weighted mean) by their standard errors alone.
/// \param estimates  at least two, each with a value and a standard error > 0.
[[nodiscard]] double probability_of_agreement(std::span<const Estimate> estimates);

/// Compares ω and γ/2ω of the test alone with the characterisation, and the pull speed with the plan. The
/// speed is that of `with` if the characterisation is used (TesterCheck::used), else of `alone`.
/// \param alone  estimate without the characterisation.
/// \param with  estimate with it.
/// \param known  the characterisation.
/// \param tester  gives gravity and, if known, the planned speed.
[[nodiscard]] TesterCheck check_tester(const TesterEstimate& alone, const TesterEstimate& with,
                                       const estimate::SharedPrior::Coupling& known,
                                       const model::Tester& tester);

}  // namespace stickslip::analysis
