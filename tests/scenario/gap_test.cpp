// Scans that were lost cost the cycles they belong to, not the test: neither its regime nor its numbers.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "core/daq/calibration.hpp"
#include "drivers/simulated/simulated_board.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip {
namespace {

constexpr double kRate_Hz = 350.0;
/// Both scenes: at rest for half a second, pulled for five.
constexpr std::size_t kPullEnds = static_cast<std::size_t>(5.4 * kRate_Hz);

struct Loss {
  std::size_t at = 0;
  std::size_t count = 0;
  int misjudged = 0;  ///< Scans by which a clock took it for longer; then it is an estimate.
};

class Played {
 public:
  explicit Played(const char* scene) {
    test::ManualClock clock;
    drivers::SimulatedBoardSettings settings;
    settings.scenes = {std::filesystem::path{STICKSLIP_SOURCE_DIR} / "config/scenes" / scene};
    auto tester = drivers::make_simulated_tester(settings, clock);
    if (!tester) throw std::runtime_error(tester.error().message);
    const daq::Calibration calibration{tester->board->info(), tester->load_cell,
                                       tester->tester.normal_load_N()};
    settings_.scan_rate_Hz = kRate_Hz;
    settings_.step_coefficient = calibration.step_coefficient();
    settings_.tester = tester->tester;
    EXPECT_TRUE(tester->board->start());
    daq::ScanBlock block;
    while (coefficients_.size() < kPullEnds &&
           tester->board->read(block, std::chrono::milliseconds{1000}) == daq::ReadStatus::kScans) {
      for (const double raw : block.scans()) coefficients_.push_back(calibration.coefficient(raw));
    }
    coefficients_.resize(kPullEnds);
  }

  [[nodiscard]] analysis::TestResults analyse(
      const Loss& loss, detect::EstimatorTier estimator = detect::EstimatorTier::kFit) const {
    analysis::AnalysisSettings settings = settings_;
    settings.estimator = estimator;
    analysis::TestAnalysis analysis{settings};
    for (std::size_t k = 0; k < coefficients_.size(); ++k) {
      if (k >= loss.at && k < loss.at + loss.count) continue;
      auto index = static_cast<base::ScanIndex>(k);
      if (loss.count > 0 && k >= loss.at + loss.count) index += loss.misjudged;
      if (loss.count > 0 && k == loss.at + loss.count) {
        const auto first = static_cast<base::ScanIndex>(loss.at);
        analysis.gap(first, index - first, loss.misjudged != 0);
      }
      analysis.add(index, coefficients_[k], false);
    }
    return analysis.finish();
  }

 private:
  analysis::AnalysisSettings settings_;
  std::vector<double> coefficients_;
};

/// The same scans less some: further apart than four standard errors of the poorer ones, they differ.
void expect_same(const analysis::Estimate& with, const analysis::Estimate& without, const char* what) {
  ASSERT_TRUE(with.value) << what << ": " << with.reason;
  ASSERT_TRUE(with.standard_error) << what;
  EXPECT_NEAR(*with.value, *without.value, 4.0 * *with.standard_error) << what;
}

TEST(Gap, CostsStickSlipTheCyclesItTouches) {
  const Played test{"stick-slip-at-12-in-per-min.toml"};
  const analysis::TestResults whole = test.analyse({});
  ASSERT_EQ(whole.regime, model::Regime::kStickSlip);
  const std::size_t step = test::kSanitized ? 790 : 223;  // 12.4 cycles: all phases
  int tried = 0;
  for (const std::size_t count : {2U, 9U, 18U, 60U, 400U}) {
    // A clock is right to a scan or two.
    for (const int misjudged : {-1, 0, 2}) {
      for (std::size_t at = 240; at + count + 350 < kPullEnds; at += step, ++tried) {
        SCOPED_TRACE(fmt::format("{} scans from {} on, off by {}", count, at, misjudged));
        const analysis::TestResults results = test.analyse({at, count, misjudged});
        ASSERT_EQ(results.regime, whole.regime) << results.regime_reason;
        // The slips on both sides, the one whose beginning was not seen, and those in between, 18 scans each.
        const double most = 4.0 + std::ceil(static_cast<double>(count) / 17.0);
        EXPECT_GE(*results.cycle_count.value, *whole.cycle_count.value - most);
        EXPECT_LE(*results.cycle_count.value, *whole.cycle_count.value);
        expect_same(results.mu_s, whole.mu_s, "S");
        expect_same(results.mu_k, whole.mu_k, "K");
        expect_same(results.delta_mu, whole.delta_mu, "S - K");
        expect_same(results.oscillation_frequency, whole.oscillation_frequency, "frequency");
      }
    }
  }
  std::printf("%d gaps\n", tried);
}

TEST(Gap, ThatHidesASlipMakesNoCycleOfTwiceTheLength) {
  const Played test{"stick-slip-at-12-in-per-min.toml"};
  const double whole_Hz = *test.analyse({}).oscillation_frequency.value;
  // A cycle has 18 scans, a slip half of them: gaps that are shorter, from every place of a cycle on.
  for (const std::size_t count : {5U, 7U, 8U}) {
    for (std::size_t at = 700; at < 718; ++at) {
      const analysis::Estimate found_Hz = test.analyse({at, count, 0}).oscillation_frequency;
      // One cycle of twice the length among 80 would be 1.2 %.
      EXPECT_NEAR(*found_Hz.value, whole_Hz, 0.003 * whole_Hz) << count << " scans from " << at << " on";
      EXPECT_LT(*found_Hz.standard_error, 0.003 * whole_Hz) << count << " scans from " << at << " on";
    }
  }
}

/// Loaded for S g/(v ω₀²) = 43 ms, a slip of half a period, 25 ms. Without them nothing tells the stick rate.
constexpr std::size_t kFirstSlipEnds = static_cast<std::size_t>((0.5 + 0.043 + 0.025) * kRate_Hz) + 6;

class GapInARingDown : public testing::TestWithParam<detect::EstimatorTier> {};

INSTANTIATE_TEST_SUITE_P(OfEachEstimator, GapInARingDown,
                         testing::Values(detect::EstimatorTier::kTurningPoints, detect::EstimatorTier::kFit),
                         [](const auto& tier) {
                           return std::string{tier.param == detect::EstimatorTier::kFit ? "Fit"
                                                                                        : "TurningPoints"};
                         });

TEST_P(GapInARingDown, NeverMakesSticking) {
  const Played test{"ring-down-at-12-in-per-min.toml"};
  const analysis::TestResults whole = test.analyse({}, GetParam());
  ASSERT_EQ(whole.regime, model::Regime::kRingDown);
  const std::size_t step = test::kSanitized ? 197 : 17;
  int undecided = 0;
  int sticking = 0;
  int tried = 0;
  for (const std::size_t count : {9U, 60U}) {
    for (const int misjudged : {0, 2}) {
      for (std::size_t at = kFirstSlipEnds; at < 700; at += step, ++tried) {
        SCOPED_TRACE(fmt::format("{} scans from {} on, off by {}", count, at, misjudged));
        const analysis::TestResults results = test.analyse({at, count, misjudged}, GetParam());
        const bool wrong =
            results.regime == model::Regime::kStickSlip || results.regime == model::Regime::kMixed;
        if (wrong) ++sticking;
        EXPECT_FALSE(wrong && GetParam() == detect::EstimatorTier::kFit) << results.regime_reason;
        if (results.regime == model::Regime::kUndecided) ++undecided;
      }
    }
  }
  std::printf("%d gaps, %d left it undecided, %d made it sticking\n", tried, undecided, sticking);
  // While the test runs little is known of ω and γ behind a gap. Of random ring-downs with spikes the other
  // estimators call 1.8 % something else (docs/detector-limits.md).
  constexpr double kCalledOtherwise = 0.018;
  EXPECT_LE(sticking, test::highest_count(tried, kCalledOtherwise));
}

}  // namespace
}  // namespace stickslip
