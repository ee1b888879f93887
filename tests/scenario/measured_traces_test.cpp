/// Traces of a real tester, paper on paper: one setting of the analysis for all of them.
#include "tests/support/measured_traces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::analysis {
namespace {

class MeasuredTraces : public testing::Test {
 protected:
  /// Reads and analyses; no results if the file is absent: a failure where it is required.
  std::optional<TestResults> analyse(const std::string& name) {
    const std::vector<double> values = test::measured_trace(name);
    if (values.empty()) {
      if (test::measured_traces_required()) {
        ADD_FAILURE() << name << " is required";
      }
      return std::nullopt;
    }
    AnalysisSettings settings;
    settings.scan_rate_Hz = test::kMeasuredScanRate_Hz;
    const test::TemporaryFolder scratch;
    settings.scratch_folder = scratch.path();
    TestAnalysis analysis{settings};
    base::ScanIndex index = 0;
    for (const double value : values) analysis.add(index++, value, false);
    return analysis.finish();
  }
};

TEST_F(MeasuredTraces, NearlySinusoidalStickSlip) {
  // Counted by eye: 131 cycles of 27.5–30 ms.
  const auto results = analyse(test::kNearlySinusoidal);
  if (!results) GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  RecordProperty("cycles", std::to_string(*results->cycle_count.value));
  RecordProperty("period_s", std::to_string(*results->period_median.value));
  RecordProperty("regime", std::string(model::name(results->regime)) + ": " + results->regime_reason);
  EXPECT_NEAR(results->cycle_count.value.value(), 131.0, 0.03 * 131.0);
  EXPECT_NEAR(results->period_median.value.value(), 0.0285, 0.02 * 0.0285);
}

TEST_F(MeasuredTraces, SawTooth) {
  // Counted by eye: 39 slips, seven of them of a third of the usual drop.
  const auto results = analyse(test::kSawTooth);
  if (!results) GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  RecordProperty("cycles", std::to_string(*results->cycle_count.value));
  RecordProperty("regime", std::string(model::name(results->regime)) + ": " + results->regime_reason);
  EXPECT_NEAR(results->cycle_count.value.value(), 39.0, 2.0);
}

/// As seen by other code: scipy.signal.find_peaks over medfilt of five scans, prominence 0.04, 0.06, 0.02 and
/// 0.009.
struct Seen {
  const char* name;
  double mean_peak;
  double middle;  ///< Of mean peak and mean trough.
};
constexpr std::array<Seen, 4> kSeen{{{"paper_k1002_v42.csv", 0.3364, 0.2913},
                                     {test::kNearlySinusoidal, 0.3564, 0.2911},
                                     {"paper_k168_v1100.csv", 0.3630, 0.3327},
                                     {test::kSawTooth, 0.3217, 0.3002}}};

// A trace that slips has S, K and S − K, also where the fit does not describe it; a finding says so. S is the
// mean peak, K the middle, S − K their difference, but for the correction for belt and damping, which is the
// systematic part, and for the wandering of the level along the track, which is in the standard error.
TEST_F(MeasuredTraces, EachThatSlipsHasItsNumbers) {
  const auto within = [](const Estimate& estimate, double seen) {
    constexpr double kSigmas = 2.0;
    EXPECT_NEAR(*estimate.value, seen, *estimate.systematic_uncertainty + kSigmas * *estimate.standard_error);
  };
  for (const Seen& trace : kSeen) {
    SCOPED_TRACE(trace.name);
    const auto results = analyse(trace.name);
    if (!results) GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
    for (const Estimate* estimate : {&results->mu_s, &results->mu_k, &results->delta_mu}) {
      ASSERT_TRUE(estimate->value) << estimate->reason;
      ASSERT_TRUE(estimate->standard_error);
      ASSERT_TRUE(estimate->systematic_uncertainty);
    }
    ASSERT_FALSE(results->findings.empty());
    EXPECT_NE(results->findings.front().find("by turning points"), std::string::npos);
    within(results->mu_s, trace.mean_peak);
    within(results->mu_k, trace.middle);
    within(results->delta_mu, trace.mean_peak - trace.middle);
    EXPECT_GT(*results->delta_mu.value, 5.0 * *results->delta_mu.standard_error);
  }
}

TEST_F(MeasuredTraces, IrregularSlidingHasNoCycles) {
  const auto results = analyse(test::kIrregularSliding);
  if (!results) GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  EXPECT_EQ(results->cycle_count.value, 0.0);
  EXPECT_EQ(results->regime, model::Regime::kSteadySliding);
  EXPECT_FALSE(results->period_median.value);
}

}  // namespace
}  // namespace stickslip::analysis
