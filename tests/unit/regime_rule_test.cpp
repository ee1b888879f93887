#include "core/detect/regime_rule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace stickslip::model {
namespace {

using detect::Description;

Regime regime_of(const std::vector<double>& ratios, Description description = Description::kFits) {
  return detect::judge_regime(ratios.size() + 1, ratios, description).regime;
}

TEST(RegimeRule, NoSlipIsSteadySliding) {
  EXPECT_EQ(detect::judge_regime(0, {}, Description::kFits).regime, Regime::kSteadySliding);
  EXPECT_EQ(detect::judge_regime(0, {}, Description::kRefuted).regime, Regime::kSteadySliding);
}

TEST(RegimeRule, OneSlipDoesNotTell) {
  const detect::RegimeVerdict verdict = detect::judge_regime(1, {}, Description::kFits);
  EXPECT_EQ(verdict.regime, Regime::kUndecided);
  EXPECT_THAT(verdict.reason, testing::HasSubstr("one slip"));
}

TEST(RegimeRule, AllCapturedIsStickSlipAndNoneIsRingDown) {
  EXPECT_EQ(regime_of({50.0, 60.0, 70.0}), Regime::kStickSlip);
  EXPECT_EQ(regime_of({-50.0, -60.0, -70.0}), Regime::kRingDown);
}

TEST(RegimeRule, OneOfEachKindIsMixedFromTheFirstChangeOn) {
  const detect::RegimeVerdict dies =
      detect::judge_regime(5, std::vector{50.0, 40.0, -30.0, -20.0}, Description::kFits);
  EXPECT_EQ(dies.regime, Regime::kMixed);
  EXPECT_EQ(dies.transition_slip, std::optional<std::size_t>{2});
  const detect::RegimeVerdict begins =
      detect::judge_regime(5, std::vector{-50.0, 40.0, 30.0, 20.0}, Description::kFits);
  EXPECT_EQ(begins.regime, Regime::kMixed);
  EXPECT_EQ(begins.transition_slip, std::optional<std::size_t>{1});
}

TEST(RegimeRule, TransitionBelongsToMixedOnly) {
  EXPECT_FALSE(detect::judge_regime(3, std::vector{50.0, 50.0}, Description::kFits).transition_slip);
  EXPECT_FALSE(detect::judge_regime(3, std::vector{-50.0, -50.0}, Description::kFits).transition_slip);
  EXPECT_FALSE(detect::judge_regime(3, std::vector{-50.0, 0.1}, Description::kFits).transition_slip);
}

TEST(RegimeRule, TwentyTimesAsLikelyDecides) {
  // One slip: captured against free differ by the ratio itself (mixed needs two slips and
  // gives it up, so it stands where the loser stands).
  const double decisive = std::log(detect::kDecisiveLikelihoodRatio);
  EXPECT_EQ(regime_of({decisive + 1e-9}), Regime::kStickSlip);
  EXPECT_EQ(regime_of({decisive - 1e-9}), Regime::kUndecided);
  EXPECT_EQ(regime_of({-decisive - 1e-9}), Regime::kRingDown);
  EXPECT_EQ(regime_of({-decisive + 1e-9}), Regime::kUndecided);
}

TEST(RegimeRule, WeakestSlipDecidesBetweenPureAndMixed) {
  // Three times captured, once in doubt: pure against mixed differ by that one and by the place of the
  // change, one of three.
  const double decisive = std::log(detect::kDecisiveLikelihoodRatio);
  const double place = std::log(3.0);
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0, decisive - place - 1e-9}), Regime::kUndecided);
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0, decisive - place + 1e-9}), Regime::kStickSlip);
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0, -decisive - place + 1e-9}), Regime::kUndecided);
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0, -decisive - place - 1e-9}), Regime::kMixed);
}

// Of many slips one looks otherwise by chance.
TEST(RegimeRule, OneSlipOfManyThatLooksOtherwiseMustOutweighThePlacesItMayHave) {
  std::vector<double> ratios(86, 5.0);
  ratios[40] = -std::log(10.0);
  EXPECT_EQ(regime_of(ratios), Regime::kStickSlip);
  EXPECT_EQ(detect::judge_regime(87, ratios, Description::kFits).captured, 86U);
  // Between others it takes two changes, each in one of 85 places; at an end, one.
  const double decisive = std::log(detect::kDecisiveLikelihoodRatio);
  for (const auto& [slip, changes] : {std::pair{40, 2.0}, std::pair{85, 1.0}, std::pair{0, 1.0}}) {
    std::vector<double> odd(86, -5.0);
    double& ratio = odd[static_cast<std::size_t>(slip)];
    const double places = changes * std::log(85.0);
    ratio = places + decisive + 1e-9;
    EXPECT_EQ(regime_of(odd), Regime::kMixed) << slip;
    ratio = places - decisive + 1e-9;
    EXPECT_EQ(regime_of(odd), Regime::kUndecided) << slip;
    ratio = places - decisive - 1e-9;
    EXPECT_EQ(regime_of(odd), Regime::kRingDown) << slip;
  }
}

TEST(RegimeRule, WithoutAModelAFewSlipsAmongManyDoNotMakeATestMixed) {
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0}, Description::kRefuted), Regime::kStickSlip);
  EXPECT_EQ(regime_of({-50.0, -50.0, -50.0}, Description::kRefuted), Regime::kRingDown);
  // Single slips that seem to go on, each among many that stick: double events of rough paper.
  std::vector<double> ratios(100, 50.0);
  ratios[20] = ratios[50] = ratios[80] = -50.0;
  EXPECT_EQ(regime_of(ratios, Description::kRefuted), Regime::kStickSlip);
  EXPECT_EQ(regime_of(ratios, Description::kFits), Regime::kMixed);
}

TEST(RegimeRule, WhereTheResidualsAreNoiseOnlyAUnanimousVoteCounts) {
  EXPECT_EQ(regime_of({50.0, 50.0, 50.0}, Description::kDoubtful), Regime::kStickSlip);
  EXPECT_EQ(regime_of({-50.0, -50.0, -50.0}, Description::kDoubtful), Regime::kRingDown);
  EXPECT_EQ(regime_of({50.0, 50.0, -50.0}, Description::kDoubtful), Regime::kUndecided);
}

TEST(RegimeRule, WithoutAModelOneChangeOfBehaviourIsMixed) {
  std::vector<double> ratios(20, 50.0);
  std::fill(ratios.begin() + 12, ratios.end(), -50.0);
  const detect::RegimeVerdict verdict = detect::judge_regime(21, ratios, Description::kRefuted);
  EXPECT_EQ(verdict.regime, Regime::kMixed);
  EXPECT_EQ(verdict.transition_slip, 12U);
}

detect::RegimeVerdict by_shape(const detect::CycleShape& shape, Regime by_ends, bool model_describes) {
  return detect::judge_by_shape(shape, {by_ends, "by ends", {}, 19, 7}, model_describes);
}

TEST(RegimeRule, TheSlipsThatStuckAreThoseOfTheRegime) {
  const auto captured = [](const std::vector<double>& ratios, Description description) {
    return detect::judge_regime(ratios.size() + 1, ratios, description).captured;
  };
  EXPECT_EQ(detect::judge_regime(0, {}, Description::kFits).captured, 0U);
  EXPECT_EQ(captured({50.0, 0.0, 40.0}, Description::kFits), 2U);
  EXPECT_EQ(captured({-50.0, -40.0, -30.0}, Description::kFits), 0U);
  EXPECT_EQ(captured({50.0, -40.0, 30.0, -20.0, -20.0}, Description::kFits), 2U);
  EXPECT_EQ(captured({50.0, -1.0}, Description::kFits), std::nullopt) << "undecided";
  // One slip of another kind among many does not count, where each may be mistaken.
  std::vector<double> ratios(30, -50.0);
  ratios[12] = 50.0;
  EXPECT_EQ(captured(ratios, Description::kRefuted), 0U);
  for (double& ratio : ratios) ratio = -ratio;
  EXPECT_EQ(captured(ratios, Description::kRefuted), 30U);
  EXPECT_THAT(detect::judge_regime(31, ratios, Description::kRefuted).reason,
              testing::HasSubstr("30 of 30 slips ended in sticking (taken one by one: 29)"));
  std::fill(ratios.begin() + 20, ratios.end(), -50.0);
  EXPECT_EQ(captured(ratios, Description::kRefuted), 20U) << "mixed: the odd one is among the captured";
  // By the shape of the cycles.
  EXPECT_EQ(by_shape({20, 1.02, 0.0}, Regime::kMixed, false).captured, 0U);
  EXPECT_EQ(by_shape({20, 3.0, 0.0}, Regime::kRingDown, false).captured, std::nullopt);
  EXPECT_EQ(by_shape({20, 3.0, 0.0}, Regime::kMixed, false).captured, 7U);
}

TEST(RegimeRule, RisesAsLongAsFallsAreASledThatNeverRests) {
  const detect::CycleShape even{20, 1.02, 0.0};
  for (const Regime by_ends : {Regime::kStickSlip, Regime::kRingDown, Regime::kMixed, Regime::kUndecided}) {
    EXPECT_EQ(by_shape(even, by_ends, false).regime, Regime::kInertialOscillation);
    EXPECT_EQ(by_shape(even, by_ends, true).regime, by_ends);
  }
}

TEST(RegimeRule, RisesLongerThanFallsAreASledThatRests) {
  const detect::CycleShape saw{20, 3.0, 0.0};
  EXPECT_EQ(by_shape(saw, Regime::kRingDown, false).regime, Regime::kStickSlip);
  EXPECT_EQ(by_shape(saw, Regime::kRingDown, true).regime, Regime::kRingDown);
  EXPECT_EQ(by_shape(saw, Regime::kMixed, false).regime, Regime::kMixed);
  for (const bool describes : {false, true})
    EXPECT_EQ(by_shape(saw, Regime::kUndecided, describes).regime, Regime::kStickSlip);
}

TEST(RegimeRule, DecayAndFewCyclesLeaveTheVerdictToTheEnds) {
  for (const detect::CycleShape& shape : {detect::CycleShape{20, 1.02, 5.0}, detect::CycleShape{7, 3.0, 0.0}})
    EXPECT_EQ(by_shape(shape, Regime::kRingDown, false).regime, Regime::kRingDown);
}

TEST(RegimeRule, SlipsThatTellNothingDoNotVote) {
  EXPECT_EQ(regime_of({50.0, 0.0, 50.0}), Regime::kStickSlip);
  EXPECT_EQ(regime_of({-50.0, 0.0, -50.0}), Regime::kRingDown);
  EXPECT_EQ(detect::judge_regime(5, std::vector{0.0, 50.0, 0.0, -50.0}, Description::kFits).transition_slip,
            3U);
}

TEST(RegimeRule, NothingKnownIsUndecidedWithAReason) {
  const detect::RegimeVerdict verdict =
      detect::judge_regime(4, std::vector{0.0, 0.0, 0.0}, Description::kFits);
  EXPECT_EQ(verdict.regime, Regime::kUndecided);
  EXPECT_THAT(verdict.reason, testing::HasSubstr("no slip tells"));
}

}  // namespace
}  // namespace stickslip::model
