#include "core/analysis/sections.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/detect/slip_rule.hpp"
#include "tests/support/model_course.hpp"

namespace stickslip::analysis {
namespace {

using test::ModelCourse;

constexpr double kSectionSigma = 0.001;
constexpr std::size_t kMost = 24;  // A hundred slips are five sections then.

std::vector<detect::Fall> slips_of(const estimate::Trace& trace) {
  detect::FallFinder finder;
  detect::SlipRule rule;
  std::vector<detect::Fall> slips;
  for (const double value : trace.value) {
    const auto fall = finder.add(value, detect::SlipRule::kHysteresisSigmas * kSectionSigma);
    if (fall && rule.is_slip(*fall, kSectionSigma)) slips.push_back(*fall);
  }
  return slips;
}

class Sections : public testing::TestWithParam<std::uint64_t> {};

TEST_P(Sections, SayWhatTheWholeSays) {
  const ModelCourse course = ModelCourse::captured(1.3, 100);
  const estimate::Trace trace = course.noisy(kSectionSigma, GetParam());
  const std::vector<detect::Fall> slips = slips_of(trace);
  ASSERT_GE(slips.size(), 95U);
  const TestEstimates whole = estimate_in_sections(trace, slips, kSectionSigma, {}, {});
  const TestEstimates parts = estimate_in_sections(trace, slips, kSectionSigma, {}, {}, {.most = kMost});
  ASSERT_TRUE(whole.model_describes);
  ASSERT_TRUE(parts.model_describes);
  EXPECT_EQ(parts.captured, whole.captured);
  ASSERT_EQ(parts.cycles.size(), slips.size());
  ASSERT_EQ(parts.log_likelihood_ratios.size(), slips.size() - 1);

  // Each section finds one S, one K and its own ω, γ and rate from a fifth of the scans. Both are estimates
  // from the same noise, so they differ by less than the errors of the less certain one.
  const auto expect_close = [](const Estimate& a, const Estimate& b) {
    ASSERT_TRUE(a.value && b.value && a.standard_error && b.standard_error);
    EXPECT_NEAR(*a.value, *b.value, 3.0 * *b.standard_error);
    EXPECT_GT(*b.standard_error, 0.8 * *a.standard_error);
    // The ends of the sections' courses say nothing of the period across them, which holds ω and the rate:
    // of five it is up to √5³ less certain.
    EXPECT_LT(*b.standard_error, 12.0 * *a.standard_error);
  };
  expect_close(whole.results.delta_mu, parts.results.delta_mu);
  expect_close(whole.results.mu_k, parts.results.mu_k);
  expect_close(whole.results.omega, parts.results.omega);
  expect_close(whole.results.gamma_over_2omega, parts.results.gamma_over_2omega);
  EXPECT_EQ(parts.results.cycle_count, Estimate{}) << "is not the model's";

  // ω, γ and r of 24 slips move S of all of them by its error in one section, and the onset along the stick.
  const double sections = static_cast<double>(slips.size()) / static_cast<double>(kMost);
  const double onset_error_s =
      parts.results.delta_mu.standard_error.value_or(0.0) * std::sqrt(sections) / course.shared.r;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const detect::Cycle a = whole.cycles[i];
    const detect::Cycle b = parts.cycles[i];
    EXPECT_EQ(b.number, a.number);
    EXPECT_EQ(b.peak_time_s, a.peak_time_s);
    EXPECT_EQ(b.flags, a.flags) << i;
    EXPECT_NEAR(b.onset_time_s, a.onset_time_s, 4.0 * onset_error_s) << i;
    EXPECT_EQ(std::isnan(b.stick_time_s), std::isnan(a.stick_time_s)) << i;
    EXPECT_EQ(std::isnan(b.period_s), std::isnan(a.period_s)) << i;
  }
  ASSERT_TRUE(whole.tester && parts.tester);
  EXPECT_NEAR(parts.tester->omega, whole.tester->omega, 3.0 * std::sqrt(parts.tester->covariance(0, 0)));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Sections, testing::Values(1, 2, 3, 4, 5));

TEST(Sections, OneSectionIsTheFitOfAll) {
  const ModelCourse course = ModelCourse::captured(1.3, 20);
  const estimate::Trace trace = course.noisy(kSectionSigma, 1);
  const std::vector<detect::Fall> slips = slips_of(trace);
  const TestEstimates exactly =
      estimate_in_sections(trace, slips, kSectionSigma, {}, {}, {.most = slips.size()});
  const TestEstimates easily = estimate_in_sections(trace, slips, kSectionSigma, {}, {});
  EXPECT_EQ(exactly.results, easily.results);
}

// Three sections, of which the second begins earlier than a thread ahead expects: a break hides how the last
// slip but one of the first ended.
TEST(Sections, OnThreadsSayTheSame) {
  estimate::Trace trace = ModelCourse::captured(1.3, 60).noisy(kSectionSigma, 1);
  const std::vector<detect::Fall> slips = slips_of(trace);
  ASSERT_GT(slips.size(), 2 * kMost);
  trace.breaks = {static_cast<std::size_t>(slips[kMost - 2].trough_at) + 2};
  const TestEstimates one = estimate_in_sections(trace, slips, kSectionSigma, {}, {}, {.most = kMost});
  const TestEstimates two =
      estimate_in_sections(trace, slips, kSectionSigma, {}, {}, {.most = kMost, .on_threads = true});
  ASSERT_TRUE(one.results.delta_mu.value);
  EXPECT_EQ(two.results, one.results);
  ASSERT_EQ(two.cycles.size(), one.cycles.size());
  for (std::size_t i = 0; i < one.cycles.size(); ++i) {
    EXPECT_EQ(two.cycles[i].number, one.cycles[i].number) << i;
    // NaN, where a slip was not fitted, has bits too.
    EXPECT_EQ(std::bit_cast<std::uint64_t>(two.cycles[i].onset_time_s),
              std::bit_cast<std::uint64_t>(one.cycles[i].onset_time_s))
        << i;
    EXPECT_EQ(two.cycles[i].flags, one.cycles[i].flags) << i;
  }
}

}  // namespace
}  // namespace stickslip::analysis
