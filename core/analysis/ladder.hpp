/// \file
/// What a rung of the ladder (rung.hpp, docs/ladder.md) leaves open: systematic uncertainties by the distance
/// to another rung, and findings.
#pragma once

#include <string>

#include "core/analysis/characterisation.hpp"
#include "core/analysis/model_results.hpp"
#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/cycle.hpp"

namespace stickslip::analysis {

/// Probability of the agreement of a test alone with the tester's characterisation below which the difference
/// of both rungs is in the systematic uncertainties: 1 in 20 tests on paper without a slope has it, too.
inline constexpr double kSlopeLevel = 0.05;

/// Standard error and systematic uncertainty together.
[[nodiscard]] double total_error(const Estimate& estimate);

/// Adds to the systematic uncertainty of S and S − K by turning points how far the slips' own fits lie from
/// them. \param fitted  no delta_mu where the fit did not converge.
void add_distance_to_fits(const base::LongColumn<detect::Cycle>& fitted, TestResults& results);

/// Adds to the systematic uncertainties of S, K and S − K how far they lie from those of another rung.
void add_distance(const TestResults& other_rung, TestResults& results);

/// Adds to the systematic uncertainty of K by turning points how far it lies from the mean force, the other
/// way to K that asks for no law. Of a sled that slides on the mean force is K. Of one that sticks and slips
/// the distance is of the size of the error that friction changing within the slips makes
/// (docs/detector-limits.md). S that was set above K by a bound becomes as uncertain.
/// \param mean_force  may have no value.
void add_distance_to_mean_force(const Estimate& mean_force, TestResults& results);

/// Whether the pull is so slow that S − K is half the drop whatever the damping.
[[nodiscard]] bool may_hold_damping(const TestResults& results);

/// Takes away what the damping tells, as it is held and not found, and adds to the systematic uncertainties
/// of K and S − K what a typical γ leaves open: γ/2ω between 0 and twice that. Peak and trough hold; K =
/// (trough + e peak)/(1 + e) with e = exp(−πγ/2ω) moves by π/2 of the amplitude for each unit of γ/2ω.
void tell_held_damping(TestResults& results);

/// Whether the sled may not have come to rest on the belt before its first slip. Friction K g takes it along:
/// without damping c = K (1 − cos ωt), and the sled reaches the belt's speed v if v ≤ K g/ω, or r/ω ≤ K.
/// Beyond that the force swings about K from the start on, up to 2K, and S is not in the trace. A fit that
/// takes the first swing for a slip finds r/ω from 0.92 K to K. \param tester  of a test in which no slip was
/// captured.
[[nodiscard]] bool may_never_have_stuck(const TesterEstimate& tester, const TestResults& results);

/// Takes away what the first slip tells, the static coefficient too, and adds the finding kFastBelt.
void void_start(const TesterEstimate& tester, double gravity_m_per_s2, TestResults& results);

/// S − K that is not told from zero lies between that and a bound: half of the bound, and as much systematic
/// uncertainty. S is as far above K; Q and the threshold speed have no value.
void tell_bound(double bound, TestResults& results);

/// Fills misfit and misfit_place.
void take_misfit(const Misfit& misfit, TestResults& results);

/// Code kNotFitted. \param why  the fit has no results.
[[nodiscard]] base::Finding turning_points_finding(const Estimate& delta_mu, const std::string& why);

/// Code kMisfit, with the likely cause.
[[nodiscard]] base::Finding misfit_finding(const Misfit& misfit, const TestResults& results);

}  // namespace stickslip::analysis
