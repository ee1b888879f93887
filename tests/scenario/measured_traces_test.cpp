/// Traces of a real tester, paper on paper: one setting of the analysis for all of them. What is expected of
/// each was written down from what is seen by eye and from the instrument's data sheet, not from what the
/// analysis says.
#include "tests/support/measured_traces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::analysis {
namespace {

using model::Regime;

struct Seen {
  const char* name;
  double cycles;     ///< By eye.
  double mean_peak;  ///< By scipy.signal.find_peaks over medfilt of five scans.
  double middle;     ///< Of mean peak and mean trough, likewise.
  Regime regime;     ///< By eye: straight rises, or none.
  /// Slow slips have one waveform, but for their gradual begin; fast ones differ from each other.
  Rung rung;
};

constexpr std::array<Seen, 4> kSeen{
    {{"paper_k1002_v42.csv", 84.0, 0.3364, 0.2913, Regime::kStickSlip, Rung::kTwoParameterLaw},
     {test::kNearlySinusoidal, 131.0, 0.3564, 0.2911, Regime::kInertialOscillation, Rung::kTurningPoints},
     {"paper_k168_v1100.csv", 108.0, 0.3630, 0.3327, Regime::kStickSlip, Rung::kTurningPoints},
     {test::kSawTooth, 39.0, 0.3217, 0.3002, Regime::kStickSlip, Rung::kTwoParameterLaw}}};

/// Every so many scans of the trace's.
constexpr std::array<std::size_t, 4> kStrides{1, 2, 5, 6};  // 2000, 1000, 400 and 333 scans/s.

class MeasuredTraces : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::measured_trace(kSeen.front().name).empty()) return;
    if (test::measured_traces_required()) GTEST_FAIL() << "the measured traces are required";
    GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  }

  /// Part [from, to) of the trace, which is 1 long.
  static TestResults analyse(const std::string& name, std::size_t stride = 1, double from = 0.0,
                             double to = 1.0, detect::EstimatorTier estimator = detect::EstimatorTier::kFit) {
    const std::vector<double> values = test::measured_trace(name);
    AnalysisSettings settings;
    settings.scan_rate_Hz = test::kMeasuredScanRate_Hz / static_cast<double>(stride);
    settings.estimator = estimator;
    const test::TemporaryFolder scratch;
    settings.scratch_folder = scratch.path();
    TestAnalysis analysis{settings};
    base::ScanIndex index = 0;
    const auto n = static_cast<double>(values.size());
    for (auto k = static_cast<std::size_t>(from * n); k < static_cast<std::size_t>(to * n); k += stride)
      analysis.add(index++, values[k], false);
    return analysis.finish();
  }
};

TEST_F(MeasuredTraces, CyclesAndRegimeAreThoseSeenByEyeAtEachScanRate) {
  for (const Seen& trace : kSeen) {
    for (const std::size_t stride : kStrides) {
      SCOPED_TRACE(std::string{trace.name} + ", every scan of " + std::to_string(stride));
      const TestResults results = analyse(trace.name, stride);
      EXPECT_NEAR(results.cycle_count.value.value(), trace.cycles, (stride <= 2 ? 0.1 : 0.15) * trace.cycles);
      EXPECT_EQ(results.regime, trace.regime) << model::name(results.regime) << ": " << results.regime_reason;
      // A slip of half the mean amplitude would have been seen.
      EXPECT_LT(results.smallest_slip.value.value(), 2.0 * results.amplitude.value.value());
    }
  }
}

// S is the mean peak, K the middle, S − K their difference, but for the correction for belt and damping,
// which is in the systematic part, and for the wandering of the level along the track, which is in the
// standard error.
TEST_F(MeasuredTraces, EachThatSlipsHasItsNumbersAndSaysWhereTheyComeFrom) {
  const auto within = [](const Estimate& estimate, double seen) {
    constexpr double kSigmas = 2.0;
    EXPECT_NEAR(*estimate.value, seen, *estimate.systematic_uncertainty + kSigmas * *estimate.standard_error);
  };
  for (const Seen& trace : kSeen) {
    SCOPED_TRACE(trace.name);
    const TestResults results = analyse(trace.name);
    for (const Estimate* estimate : {&results.mu_s, &results.mu_k, &results.delta_mu}) {
      ASSERT_TRUE(estimate->value) << estimate->reason;
      ASSERT_TRUE(estimate->standard_error);
      ASSERT_TRUE(estimate->systematic_uncertainty);
    }
    EXPECT_EQ(results.rung, trace.rung) << name(results.rung);
    EXPECT_FALSE(results.rung_reason.empty());
    EXPECT_EQ(results.rung_reason.find("converge"), std::string::npos)
        << "no physical reason: " << results.rung_reason;
    ASSERT_FALSE(results.findings.empty());
    within(results.mu_s, trace.mean_peak);
    within(results.mu_k, trace.middle);
    within(results.delta_mu, trace.mean_peak - trace.middle);
    EXPECT_GT(*results.delta_mu.value, 5.0 * *results.delta_mu.standard_error);
    // The tester of these traces is not characterised.
    EXPECT_FALSE(results.mu_slope.value);
    EXPECT_FALSE(results.gamma_over_2omega.value);
  }
}

// Before each slip the slope bends over: the sled creeps.
TEST_F(MeasuredTraces, MisfitOfSlowSlipsIsInTheirGradualBegin) {
  for (const Seen& trace : kSeen) {
    if (trace.rung != Rung::kTwoParameterLaw) continue;
    const TestResults results = analyse(trace.name);
    EXPECT_GT(results.misfit.value.value(), 0.5) << trace.name;
    EXPECT_EQ(results.misfit_place, "peak") << trace.name;
  }
}

// Written down before the findings were looked at, from the README of the traces: all are cut out of a longer
// pull. Two are saw-teeth with creep before each slip and a level that drifts or wanders; those of rounded or
// scattered cycles have no law; the one that slides hums by 0.004 at 50 Hz. None clips, is frozen or has
// coarse steps.
TEST_F(MeasuredTraces, EachHasTheFindingsThatAnExpertNames) {
  const std::pair<const char*, std::vector<std::string>> expected[] = {
      {"paper_k1002_v42.csv", {"begins-under-load", "misfit"}},
      {"paper_k168_v42.csv", {"begins-under-load", "misfit"}},
      {"paper_k168_v1100.csv", {"begins-under-load", "not-fitted"}},
      {test::kNearlySinusoidal, {"begins-under-load", "not-fitted"}},
      {test::kIrregularSliding, {"begins-under-load", "hum"}}};
  for (const auto& [name, codes] : expected) {
    std::vector<std::string> found;
    for (const base::Finding& finding : analyse(name).findings) found.push_back(finding.code);
    std::ranges::sort(found);
    EXPECT_EQ(found, codes) << name;
  }
}

TEST_F(MeasuredTraces, FitAndTurningPointsAgree) {
  for (const Seen& trace : kSeen) {
    SCOPED_TRACE(trace.name);
    const TestResults fit = analyse(trace.name);
    const TestResults points = analyse(trace.name, 1, 0.0, 1.0, detect::EstimatorTier::kTurningPoints);
    for (const auto quantity : {&TestResults::mu_s, &TestResults::mu_k, &TestResults::delta_mu}) {
      const Estimate& one = fit.*quantity;
      const Estimate& other = points.*quantity;
      EXPECT_NEAR(*one.value, *other.value,
                  2.0 * std::hypot(*one.standard_error, *other.standard_error) + *one.systematic_uncertainty +
                      *other.systematic_uncertainty);
    }
  }
}

/// Rms of the differences of neighbouring parts of the traces, 20 to 60 cycles each, over their standard
/// errors.
double rms_of_differences(Estimate TestResults::*quantity,
                          const std::vector<std::vector<TestResults>>& parts) {
  double sum = 0.0;
  double count = 0.0;
  for (const std::vector<TestResults>& of_trace : parts) {
    double own = 0.0;
    for (std::size_t i = 0; i + 1 < of_trace.size(); ++i) {
      const Estimate& a = of_trace[i].*quantity;
      const Estimate& b = of_trace[i + 1].*quantity;
      own += std::pow(*a.value - *b.value, 2) /
             (std::pow(*a.standard_error, 2) + std::pow(*b.standard_error, 2));
    }
    sum += own / static_cast<double>(of_trace.size() - 1);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

// Levels wander along the track, and their errors say so: scatter over √n would be three to seven times too
// small.
TEST_F(MeasuredTraces, NeighbouringPartsDifferByTheirErrors) {
  const std::array<std::vector<int>, kSeen.size()> parts_of{{{2, 3, 4}, {3, 4, 6}, {2, 3, 5}, {2}}};
  for (const auto estimator : {detect::EstimatorTier::kFit, detect::EstimatorTier::kTurningPoints}) {
    SCOPED_TRACE(detect::name(estimator));
    std::vector<std::vector<TestResults>> parts;
    for (std::size_t trace = 0; trace < kSeen.size(); ++trace) {
      for (const int count : parts_of[trace]) {
        parts.emplace_back();
        for (int i = 0; i < count; ++i)
          parts.back().push_back(analyse(kSeen[trace].name, 1, i / static_cast<double>(count),
                                         (i + 1) / static_cast<double>(count), estimator));
      }
    }
    for (const auto& [name, quantity] :
         {std::pair{"S", &TestResults::mu_s}, std::pair{"K", &TestResults::mu_k},
          std::pair{"S - K", &TestResults::delta_mu}}) {
      const double rms = rms_of_differences(quantity, parts);
      RecordProperty(fmt::format("rms of {}, {}", name, detect::name(estimator)), std::to_string(rms));
      EXPECT_GT(rms, 0.8) << name;
      EXPECT_LT(rms, 1.3) << name;
    }
  }
}

TEST_F(MeasuredTraces, IrregularSlidingHasNoCycles) {
  for (const std::size_t stride : kStrides) {
    const TestResults results = analyse(test::kIrregularSliding, stride);
    EXPECT_EQ(results.cycle_count.value, 0.0);
    EXPECT_EQ(results.regime, Regime::kSteadySliding);
    EXPECT_FALSE(results.period_median.value);
    EXPECT_EQ(results.rung, Rung::kNone);
  }
}

}  // namespace
}  // namespace stickslip::analysis
