/// \file
/// The ladder (docs/ladder.md): the description of a trace from which S, K and S − K come is a rung
/// (rung.hpp). Here: systematic uncertainties for what a rung leaves open, such as the distance to another
/// rung, added by add_systematic(), and findings.
#pragma once

#include <string>

#include "core/analysis/characterisation.hpp"
#include "core/analysis/model_results.hpp"
#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/cycle.hpp"

namespace stickslip::analysis {

/// TesterCheck::probability below which the distance between the results with and without the
/// characterisation is added to the systematic uncertainties of S, K and S − K, as long as the
/// characterisation is used (TesterCheck::used()) and its fit describes the test. Without a slope of K 1 in
/// 20 tests lies below it by chance.
inline constexpr double kSlopeLevel = 0.05;

/// Standard error and systematic uncertainty, added in quadrature; one that is unknown counts as 0.
[[nodiscard]] double total_error(const Estimate& estimate);

/// Adds to the systematic uncertainties of S and S − K, found by turning points, the distance between this
/// S − K and the mean S − K of the fitted slips. Does nothing if either has no value.
/// \param fitted  cycles from cycle_table(); delta_mu is NaN where the fit did not converge.
void add_distance_to_fits(const base::LongColumn<detect::Cycle>& fitted, TestResults& results);

/// Adds to the systematic uncertainty of each of S, K and S − K its distance to the same result of another
/// rung. A result that either rung lacks stays as it is.
void add_distance(const TestResults& other_rung, TestResults& results);

/// Adds to the systematic uncertainty of K, found by turning points, the distance between K and the mean
/// force; the same to that of S if tell_bound() set S above K. The mean force is another estimate of K, which
/// needs no friction law. Of a sled that slides on, the mean force is K. Of one that sticks and slips, the
/// distance is of the size of the error that friction changing within the slips makes
/// (docs/detector-limits.md). Does nothing without a mean force or without K.
/// \param mean_force  as a coefficient; may have no value.
void add_distance_to_mean_force(const Estimate& mean_force, TestResults& results);

/// Whether the pull is so slow (Q < 0.2) that S − K is half the drop whatever the damping; false without Q.
[[nodiscard]] bool may_hold_damping(const TestResults& results);

/// For a fit whose γ/2ω was held at kTypicalGammaOver2Omega. Sets gamma_over_2omega, Q_threshold,
/// threshold_speed and slip_speed_ratio_threshold to absent, since they were not found. Adds to the
/// systematic uncertainties of K and S − K what γ/2ω between 0 and twice the typical value leaves open. Peak
/// and trough are known; K = (trough + e peak)/(1 + e) with e = exp(−πγ/2ω) moves by π/2 of the amplitude for
/// each unit of γ/2ω.
void tell_held_damping(TestResults& results);

/// Whether r/ω > 0.9 K, so that the sled may not have come to rest on the belt before its first slip. False
/// if K has no value. Friction K g takes the sled along: without damping c = K (1 − cos ωt), and the sled
/// reaches the belt's speed v if v ≤ K g/ω, or r/ω ≤ K. Beyond that the force swings about K from the start
/// on, up to 2K, and S is not in the trace. A fit that takes the first swing for a slip finds r/ω from 0.92 K
/// to K.
/// \param tester  of a test in which no slip was captured.
[[nodiscard]] bool may_never_have_stuck(const TesterEstimate& tester, const TestResults& results);

/// Sets to absent what the first slip would tell: static_coefficient, mu_s, delta_mu, Q, threshold_speed and
/// pull_speed_measured. Adds the finding kFastBelt, with the speed K g/ω up to which a sled comes to rest on
/// the belt. Call it only where may_never_have_stuck().
/// \param tester  as for may_never_have_stuck(). \param results  with mu_k.
void void_start(const TesterEstimate& tester, double gravity_m_per_s2, TestResults& results);

/// Sets S − K, which lies between 0 and `bound` and is not told from 0, to half of the bound, with as much
/// systematic uncertainty. Sets S to K plus half the bound, with the systematic uncertainty of K and that
/// half. Neither has a standard error. Without K, S stays as it is. Q and threshold_speed become absent.
void tell_bound(double bound, TestResults& results);

/// Fills misfit, and misfit_place if the misfit has a place.
void take_misfit(const Misfit& misfit, TestResults& results);

/// Finding kNotFitted: S and K come from turning points, or, without delta_mu, have no value.
/// \param why  reason why the fit has no results, as a clause.
[[nodiscard]] base::Finding turning_points_finding(const Estimate& delta_mu, const std::string& why);

/// Finding kMisfit, with the likely cause.
/// \param results  delta_mu already has its distance to turning points, by add_distance().
[[nodiscard]] base::Finding misfit_finding(const Misfit& misfit, const TestResults& results);

}  // namespace stickslip::analysis
