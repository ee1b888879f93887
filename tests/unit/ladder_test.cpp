// What a rung leaves open: the distance to another rung is a systematic part, a damping that was held is no
// result, and a misfit names its place and likely cause.

#include "core/analysis/ladder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/analysis/cycle_statistics.hpp"

namespace stickslip::analysis {
namespace {

using testing::HasSubstr;

TestResults with_levels(double mu_s, double mu_k) {
  TestResults results;
  results.mu_s = Estimate::of(mu_s, 0.001);
  results.mu_k = Estimate::of(mu_k, 0.001);
  results.delta_mu = Estimate::of(mu_s - mu_k, 0.001);
  return results;
}

TEST(Ladder, TheDistanceToAnotherRungIsASystematicPart) {
  TestResults results = with_levels(0.33, 0.28);
  results.mu_k.systematic_uncertainty = 0.5;
  add_distance(with_levels(0.34, 0.26), results);
  EXPECT_NEAR(results.mu_s.systematic_uncertainty.value(), 0.01, 1e-15);
  EXPECT_NEAR(results.mu_k.systematic_uncertainty.value(), 0.52, 1e-15);
  EXPECT_NEAR(results.delta_mu.systematic_uncertainty.value(), 0.03, 1e-15);
  EXPECT_NEAR(results.delta_mu.systematic_parts[UncertaintySource::kRung].value(), 0.03, 1e-15);
}

TEST(Ladder, ARungWithoutAValueIsNoDistance) {
  TestResults results = with_levels(0.33, 0.28);
  TestResults other = with_levels(0.34, 0.26);
  other.mu_s = Estimate::none("no slip");
  results.mu_k = Estimate::none("no slip");
  add_distance(other, results);
  EXPECT_FALSE(results.mu_s.systematic_uncertainty);
  EXPECT_FALSE(results.mu_k.systematic_uncertainty);
  EXPECT_TRUE(results.delta_mu.systematic_uncertainty);
}

TEST(Ladder, TurningPointsAreAsFarOffAsTheMeanOfTheFitsOfSlips) {
  TestResults results = with_levels(0.33, 0.28);
  std::vector<detect::Cycle> rows(3);
  rows[0].delta_mu = 0.06;
  rows[1].delta_mu = std::nan("");
  rows[2].delta_mu = 0.08;
  add_distance_to_fits(rows, results);
  EXPECT_NEAR(results.delta_mu.systematic_uncertainty.value(), 0.02, 1e-15);
  EXPECT_NEAR(results.mu_s.systematic_uncertainty.value(), 0.02, 1e-15);
  EXPECT_NEAR(results.mu_s.systematic_parts[UncertaintySource::kRung].value(), 0.02, 1e-15);
  EXPECT_FALSE(results.mu_k.systematic_uncertainty);
}

TEST(Ladder, KByTurningPointsIsAsFarOffAsTheMeanForce) {
  TestResults results = with_levels(0.33, 0.28);
  add_distance_to_mean_force(Estimate::of(0.27), results);
  EXPECT_NEAR(results.mu_k.systematic_parts[UncertaintySource::kRung].value(), 0.01, 1e-15);
  EXPECT_NEAR(results.mu_k.systematic_uncertainty.value(), 0.01, 1e-15);
  EXPECT_FALSE(results.mu_s.systematic_uncertainty);
  EXPECT_FALSE(results.delta_mu.systematic_uncertainty);

  add_distance_to_mean_force(Estimate::none("only one peak"), results);
  EXPECT_NEAR(results.mu_k.systematic_uncertainty.value(), 0.01, 1e-15);
}

// S = K + half the bound: no surer than K.
TEST(Ladder, SThatABoundSetsAboveKIsAsFarOff) {
  TestResults results = with_levels(0.28, 0.28);
  tell_bound(0.02, results);
  add_distance_to_mean_force(Estimate::of(0.25), results);
  EXPECT_NEAR(results.mu_s.systematic_uncertainty.value(), 0.01 + 0.03, 1e-15);
}

TEST(Ladder, DampingMayBeHeldFarBelowTheThresholdAlone) {
  TestResults results;
  EXPECT_FALSE(may_hold_damping(results)) << "Q is unknown";
  results.Q = Estimate::of(0.19);
  EXPECT_TRUE(may_hold_damping(results));
  results.Q = Estimate::of(0.21);
  EXPECT_FALSE(may_hold_damping(results));
}

TEST(Ladder, AHeldDampingIsNoResult) {
  TestResults results = with_levels(0.33, 0.28);
  results.amplitude = Estimate::of(0.05);
  results.gamma_over_2omega = Estimate::of(0.022);
  results.threshold_speed = Estimate::of(0.1);
  tell_held_damping(results);
  // K moves by pi/2 of the amplitude for each unit of gamma/2omega.
  const double shift = 0.5 * std::numbers::pi * 0.05 * model::kTypicalGammaOver2Omega;
  EXPECT_NEAR(results.mu_k.systematic_uncertainty.value(), shift, 1e-15);
  EXPECT_NEAR(results.delta_mu.systematic_uncertainty.value(), shift, 1e-15);
  EXPECT_NEAR(results.delta_mu.systematic_parts[UncertaintySource::kDamping].value(), shift, 1e-15);
  EXPECT_FALSE(results.mu_s.systematic_uncertainty);
  for (const Estimate* estimate : {&results.gamma_over_2omega, &results.Q_threshold, &results.threshold_speed,
                                   &results.slip_speed_ratio_threshold}) {
    EXPECT_FALSE(estimate->value);
    EXPECT_THAT(estimate->reason, HasSubstr("damping is held"));
  }
}

base::LongColumn<detect::Fall> slips_at(const std::vector<double>& levels) {
  base::LongColumn<detect::Fall> slips;
  for (const double level : levels) {
    detect::Fall slip;
    slip.peak = level + 0.05;
    slip.trough = level - 0.05;
    slips.push_back(slip);
  }
  return slips;
}

TEST(LevelDrift, IsToldFromThreeStandardErrorsOfTheThirdsOn) {
  // Levels 0.3 ± 0.001 in turn: with the next peak the centre is half as far off, the mean of a third of 8 by
  // 0.0005/√7, their difference by √2 times that. Three standard deviations are 3.6 of 14 degrees of freedom.
  const double error = 0.0005 / std::sqrt(7.0) * std::numbers::sqrt2;
  const auto levels = [&](double step) {
    std::vector<double> values;
    for (int i = 0; i < 25; ++i)
      values.push_back(0.3 + (i % 2 == 0 ? 0.001 : -0.001) + (i < 16 ? 0.0 : step));
    return values;
  };
  EXPECT_FALSE(level_finding({}, slips_at(levels(0.0))));
  EXPECT_FALSE(level_finding({}, slips_at(levels(1.5 * error))));
  const auto found = level_finding({}, slips_at(levels(6.0 * error)));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->code, "level-drift");
  // Fewer than eight slips in a third tell nothing of how they wander.
  auto few = levels(6.0 * error);
  few.pop_back();
  EXPECT_FALSE(level_finding({}, slips_at(few)));
}

}  // namespace
}  // namespace stickslip::analysis
