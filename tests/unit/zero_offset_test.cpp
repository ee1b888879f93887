// A zero that is off shifts levels, not differences.

#include "core/pipeline/zero_offset.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stickslip::pipeline {
namespace {

using analysis::UncertaintySource;

analysis::TestResults some_results() {
  analysis::TestResults results;
  results.static_coefficient = analysis::Estimate::of(0.38, 0.001);
  results.mu_k = analysis::Estimate::of(0.3, 0.001);
  results.mu_k.systematic_uncertainty = 0.03;
  results.delta_mu = analysis::Estimate::of(0.05, 0.001);
  return results;
}

TEST(ZeroOffset, IsAFindingAndASystematicPartOfLevelsAlone) {
  analysis::TestResults results = some_results();
  add_zero_offset(results, -0.04, 0.01);
  ASSERT_EQ(results.findings.size(), 1U);
  EXPECT_NE(results.findings[0].text.find("-0.0400"), std::string::npos) << results.findings[0].text;
  EXPECT_DOUBLE_EQ(results.static_coefficient.systematic_uncertainty.value_or(0.0), 0.04);
  EXPECT_DOUBLE_EQ(results.mu_k.systematic_uncertainty.value_or(0.0), 0.05);
  EXPECT_DOUBLE_EQ(results.mu_k.systematic_parts[UncertaintySource::kZero].value_or(0.0), 0.04);
  EXPECT_FALSE(results.delta_mu.systematic_uncertainty);
  EXPECT_FALSE(results.kinetic_coefficient.systematic_uncertainty) << "there is no value";
}

TEST(ZeroOffset, TheWorseOfTheTwoCounts) {
  analysis::TestResults results = some_results();
  add_zero_offset(results, 0.004, -0.02);
  ASSERT_EQ(results.findings.size(), 1U);
  EXPECT_NE(results.findings[0].text.find("-0.0200 after"), std::string::npos) << results.findings[0].text;
  EXPECT_DOUBLE_EQ(results.static_coefficient.systematic_uncertainty.value_or(0.0), 0.02);
}

TEST(ZeroOffset, WithinTheLimitOrUnknownChangesNothing) {
  for (const std::optional<double> level :
       {std::optional<double>{}, std::optional{0.0025}, std::optional{-0.001}, std::optional{std::nan("")}}) {
    analysis::TestResults results = some_results();
    add_zero_offset(results, level, level);
    EXPECT_TRUE(results.findings.empty());
    EXPECT_FALSE(results.static_coefficient.systematic_uncertainty);
    // A level that was read is known to add nothing; one that was not is unknown.
    const bool is_known = level && std::isfinite(*level);
    EXPECT_EQ(results.static_coefficient.systematic_parts[UncertaintySource::kZero],
              is_known ? std::optional{0.0} : std::nullopt);
    EXPECT_EQ(results.delta_mu, some_results().delta_mu);
  }
}

}  // namespace
}  // namespace stickslip::pipeline
