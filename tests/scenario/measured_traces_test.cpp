/// Traces of a real tester, paper on paper: one setting of the analysis for all of them.
#include "tests/support/measured_traces.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "core/analysis/test_analysis.hpp"

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

TEST_F(MeasuredTraces, IrregularSlidingHasNoCycles) {
  const auto results = analyse(test::kIrregularSliding);
  if (!results) GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  EXPECT_EQ(results->cycle_count.value, 0.0);
  EXPECT_EQ(results->regime, model::Regime::kSteadySliding);
  EXPECT_FALSE(results->period_median.value);
}

}  // namespace
}  // namespace stickslip::analysis
