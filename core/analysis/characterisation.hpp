/// \file
/// ω and γ belong to the tester, not to the paper: measured once on ring-downs, they hold for every test
/// until something is changed, and every test is a check of them and of its pull speed.
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

/// What one test says about the tester, with the paper's numbers estimated beside it.
struct TesterEstimate {
  double omega = 0.0;  ///< rad/s
  double gamma_over_2omega = 0.0;
  double speed_over_gravity_s = 0.0;  ///< v/g = r/ω₀², from the slope of the sticks.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  /// \param covariance  of (ω, γ, r).
  [[nodiscard]] static TesterEstimate from(const model::SharedParameters& shared,
                                           const Eigen::Matrix3d& covariance);
};

struct Characterisation {
  estimate::SharedPrior::Coupling coupling;  ///< Covariance widened if the ring-downs disagree.
  int ring_downs = 0;
  double chi_squared = 0.0;  ///< Of the ring-downs about their mean.
  int freedom = 0;           ///< 2 (ring_downs − 1)

  /// Probability of a χ² at least this large if they agree; 1 for a single ring-down.
  [[nodiscard]] double probability() const;
};

/// Probability below which a disagreement is a finding. Every test is asked: at one in ten thousand a season
/// of tests on a sound tester hardly raises one, while a changed spring is off by many standard errors.
inline constexpr double kDisagreement = 1e-4;
/// Probability below which the characterisation is not used for the test. γ of ten cycles alone is 28 times
/// less certain: at one in ten thousand chance alone made the rms error of γ 1.8 times the bound, here it
/// adds 0.1 %.
inline constexpr double kNotThisTester = 1e-7;

/// Mean of the ring-downs, weighted by their covariances. Where they differ more than those say (χ² above its
/// freedom) the covariance is widened by that ratio [Birge, Phys. Rev. 40:207–227, 1932].
/// \return nothing if there is none or a covariance is singular.
[[nodiscard]] std::optional<Characterisation> pool_ring_downs(std::span<const TesterEstimate> ring_downs);

/// Part by which the speed may be off before it is a finding: belts keep a twentieth, wrong settings do not.
inline constexpr double kSpeedTolerance = 0.05;

/// What a test says about the tester that was characterised.
struct TesterCheck {
  double chi_squared = 0.0;  ///< Of ω and γ/2ω of the test alone, two degrees of freedom.
  double probability = 1.0;
  Estimate pull_speed;                ///< m/s, from the stick slope and ω₀.
  std::vector<std::string> findings;  ///< For people; empty: nothing to object to.

  [[nodiscard]] bool agrees() const noexcept { return probability >= kDisagreement; }
  /// The characterisation counts for this test.
  [[nodiscard]] bool used() const noexcept { return probability >= kNotThisTester; }
};

/// v = (v/g) g, m/s, with its standard error.
[[nodiscard]] Estimate pull_speed_of(const TesterEstimate& estimate, double gravity_m_per_s2);

/// What to say if the speed measured is not the planned one: off by kSpeedTolerance and three standard
/// errors. Nothing if there is no plan or no speed.
[[nodiscard]] std::optional<std::string> speed_finding(const Estimate& measured_m_per_s,
                                                       const model::Tester& tester);

/// \param alone  the test without the characterisation. \param with  the same with it: only there the speed
///               is known well. \param tester  with the planned speed, if there is a plan.
[[nodiscard]] TesterCheck check_tester(const TesterEstimate& alone, const TesterEstimate& with,
                                       const estimate::SharedPrior::Coupling& known,
                                       const model::Tester& tester);

}  // namespace stickslip::analysis
