// The three practical problems of [Penner 1995, Experimental], spikes, downward drift and a first peak that
// is not representative: each left uncorrected alone moves the numbers by as much as theory says, and
// corrected it does not.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/plain_pull.hpp"

namespace stickslip::detect {
namespace {

using test::PlainPull;
constexpr double kRate_Hz = PlainPull::kRate_Hz;
constexpr double kIdle_s = PlainPull::kIdle_s;
constexpr double kPull_s = 3.0;
constexpr double kNoise = PlainPull::kNoise;
constexpr double kK = 0.30;
constexpr double kDeltaMu = 0.05;

std::vector<double> pulled(double delta_mu, const std::string& effects) {
  return PlainPull{.K = kK, .delta_mu = delta_mu, .pull_s = kPull_s, .effects = effects}.coefficients();
}

struct Found {
  analysis::TestResults results;
  std::vector<Cycle> cycles;
  std::vector<Cycle>
      live;  ///< As they were seen one by one, from which the estimators of single cycles have theirs.
};

/// Mean and number of the S − K of cycles, from the first or the second on.
std::pair<double, double> mean_delta_mu(const std::vector<Cycle>& cycles, std::size_t from) {
  double sum = 0.0;
  double n = 0.0;
  for (std::size_t i = from; i < cycles.size(); ++i) {
    if (!std::isfinite(cycles[i].delta_mu)) continue;
    sum += cycles[i].delta_mu;
    n += 1.0;
  }
  return {sum / n, n};
}

Found analysed(const std::vector<double>& values, const analysis::SkippedCorrections& skipped,
               EstimatorTier tier = EstimatorTier::kFit) {
  analysis::AnalysisSettings settings;
  settings.scan_rate_Hz = kRate_Hz;
  settings.skipped = skipped;
  settings.estimator = tier;
  analysis::TestAnalysis analysis{settings};
  for (std::size_t k = 0; k < values.size(); ++k) {
    analysis.add(static_cast<base::ScanIndex>(k), values[k], false);
  }
  analysis.end_live();
  std::vector<Cycle> live = analysis.take_new_cycles();
  Found found{analysis.finish(), {}, std::move(live)};
  found.cycles.assign(analysis.cycles().begin(), analysis.cycles().end());
  return found;
}

/// Highest scan near the peak of a cycle.
std::size_t highest_scan(const std::vector<double>& values, const Cycle& cycle) {
  const auto peak = values.begin() + cycle.first_scan;
  return static_cast<std::size_t>(std::max_element(peak - 2, peak + 3) - values.begin());
}

TEST(SkippedCorrections, NamesReadBack) {
  EXPECT_TRUE(analysis::skipped_from_text("")->none());
  for (const char* text : {"spikes", "drift", "first-slip", "spikes,drift", "spikes,drift,first-slip"})
    EXPECT_EQ(analysis::text_of(*analysis::skipped_from_text(text)), text);
  EXPECT_EQ(analysis::text_of(*analysis::skipped_from_text("drift,spikes")), "spikes,drift");
  EXPECT_FALSE(analysis::skipped_from_text("hum"));
  EXPECT_FALSE(analysis::skipped_from_text("spikes drift"));
  EXPECT_EQ(analysis::text_of(analysis::either({.drift = true}, {.spikes = true})), "spikes,drift");
}

// A spike on the first peak is the static coefficient of the tradition, to its full height.
TEST(SkippedCorrections, SpikeOnTheFirstPeakIsTheStaticCoefficient) {
  constexpr double kSpike = 0.1;
  std::vector<double> values = pulled(kDeltaMu, "");
  const Found clean = analysed(values, {});
  const std::size_t peak = highest_scan(values, clean.cycles.front());
  const double without = values[peak];
  values[peak] += kSpike;
  const Found uncorrected = analysed(values, {.spikes = true});
  EXPECT_EQ(*uncorrected.results.static_coefficient.value, without + kSpike);
  EXPECT_FALSE(uncorrected.results.spike_count.value);
  const Found corrected = analysed(values, {});
  EXPECT_EQ(*corrected.results.spike_count.value, *clean.results.spike_count.value + 1.0);
  // The neighbours of a peak lie lower by half the amplitude, 0.08, times (ω dt)², 0.36², at most.
  EXPECT_NEAR(*corrected.results.static_coefficient.value, without, 0.5 * 0.08 * 0.36 * 0.36 + 4.0 * kNoise);
}

// A ring-down has one K. It is that at the onset; with the drift left in, that in the middle of all its
// scans.
TEST(SkippedCorrections, DriftMovesKOfARingDownToTheMiddleOfThePull) {
  constexpr double kDrift_per_s = -0.004;
  const std::vector<double> values = pulled(
      0.025,
      fmt::format("[effects.kinetic_drift]\nchange = {}\nover = \"{} s\"\n", kDrift_per_s * 5.0 / kK, 5.0));
  const Found corrected = analysed(values, {});
  const Found uncorrected = analysed(values, {.drift = true});
  ASSERT_EQ(corrected.results.regime, model::Regime::kRingDown);
  ASSERT_EQ(uncorrected.results.regime, model::Regime::kRingDown);
  ASSERT_TRUE(uncorrected.results.mu_k.value) << uncorrected.results.mu_k.reason;
  // The fit goes from the onset to one and a half oscillations after the last trough that stands out.
  const double onset_s = corrected.cycles.front().onset_time_s;
  const double half_s = 0.5 * (corrected.cycles.back().peak_time_s + 2.0 / 20.0 - onset_s);
  const double drift_per_s = *corrected.results.drift_rate.value;
  const double drift_error_per_s = *corrected.results.drift_rate.standard_error;
  EXPECT_NEAR(drift_per_s, kDrift_per_s, 4.0 * drift_error_per_s);
  EXPECT_NEAR(*corrected.results.mu_k.value, kK + kDrift_per_s * onset_s,
              4.0 * drift_error_per_s * half_s + 4.0 * *corrected.results.mu_k.standard_error);
  // The oscillation that dies away weighs its part of the scans otherwise than the rest.
  EXPECT_NEAR(*uncorrected.results.mu_k.value - *corrected.results.mu_k.value, drift_per_s * half_s,
              0.05 * std::abs(drift_per_s * half_s));
}

// Stick-slip has a K for each slip. n of them in a line, a period apart, scatter by β P √(n (n + 1)/12), of
// which their mean has the nth root: the drift left in looks like uncertainty.
TEST(SkippedCorrections, DriftLooksLikeALevelThatWanders) {
  constexpr double kDrift_per_s = -0.03;
  const std::vector<double> values = pulled(
      kDeltaMu,
      fmt::format("[effects.kinetic_drift]\nchange = {}\nover = \"{} s\"\n", kDrift_per_s * 5.0 / kK, 5.0));
  const Found corrected = analysed(values, {});
  const Found uncorrected = analysed(values, {.drift = true});
  ASSERT_EQ(uncorrected.results.regime, model::Regime::kStickSlip);
  const double n = static_cast<double>(uncorrected.cycles.size()) - 1.0;
  const double expected =
      std::abs(kDrift_per_s) * *uncorrected.results.period_median.value * std::sqrt((n + 1.0) / 12.0);
  // Scatter about the mean makes at least the error of independent values; but a drift is a level that
  // wanders, of which at most the range of K is left open.
  EXPECT_GT(*uncorrected.results.mu_k.standard_error, expected * (1.0 - 1.5 / n));
  EXPECT_LT(*uncorrected.results.mu_k.standard_error, expected * std::sqrt(12.0 * n));
  EXPECT_LT(*corrected.results.mu_k.standard_error, 0.2 * expected);
}

class FirstSlipCounted : public testing::TestWithParam<EstimatorTier> {};

// S of the first slip is higher by δ: n slips have a mean that is higher by δ/n.
TEST_P(FirstSlipCounted, RaisesTheMeanByItsShare) {
  constexpr double kChange = 0.03;
  const std::vector<double> values =
      pulled(kDeltaMu, fmt::format("[effects.first_peak]\nchange = {}\n", kChange));
  const Found corrected = analysed(values, {}, GetParam());
  const Found uncorrected = analysed(values, {.first_slip = true}, GetParam());
  ASSERT_TRUE(corrected.results.delta_mu.value);
  ASSERT_TRUE(uncorrected.results.delta_mu.value);
  const bool fitted = GetParam() == EstimatorTier::kFit;
  const std::vector<Cycle>& cycles = fitted ? uncorrected.cycles : uncorrected.live;
  const Cycle& first = cycles.front();
  const auto [others, n] = mean_delta_mu(cycles, 1);
  if (fitted) {
    // Slips that agree are fitted as one without the first, and each with its own S and K with it.
    EXPECT_NEAR(*corrected.results.delta_mu.value, kDeltaMu,
                4.0 * *corrected.results.delta_mu.standard_error);
    EXPECT_NEAR(first.delta_mu, kDeltaMu + kChange, 4.0 * first.delta_mu_standard_error);
  } else {
    EXPECT_NEAR(*corrected.results.delta_mu.value, others, 1e-12);
  }
  EXPECT_NEAR(*uncorrected.results.delta_mu.value, mean_delta_mu(cycles, 0).first, 1e-12);
  EXPECT_NEAR(*uncorrected.results.delta_mu.value - others, (first.delta_mu - others) / (n + 1.0), 1e-12);
  EXPECT_GT(first.delta_mu - others, 0.5 * kChange);
  EXPECT_LT(first.delta_mu - others, 1.2 * kChange);
}

INSTANTIATE_TEST_SUITE_P(OfEachEstimator, FirstSlipCounted,
                         testing::Values(EstimatorTier::kTurningPoints, EstimatorTier::kFit),
                         [](const auto& tier) {
                           return std::string{tier.param == EstimatorTier::kFit ? "Fit" : "TurningPoints"};
                         });

// Where the first slip is like the others it may as well count: it is one more, in the fit of all as one too.
TEST(SkippedCorrections, FirstSlipLikeTheOthersChangesNothingButTheNumber) {
  const std::vector<double> values = pulled(kDeltaMu, "");
  const Found corrected = analysed(values, {});
  const Found uncorrected = analysed(values, {.first_slip = true});
  EXPECT_NEAR(*uncorrected.results.delta_mu.value, *corrected.results.delta_mu.value,
              *corrected.results.delta_mu.standard_error);
  EXPECT_LE(*uncorrected.results.delta_mu.standard_error, *corrected.results.delta_mu.standard_error);
  EXPECT_TRUE(uncorrected.results.delta_mu_from_amplitude.value);
  EXPECT_NE(uncorrected.results.delta_mu_from_amplitude, corrected.results.delta_mu_from_amplitude);
}

}  // namespace
}  // namespace stickslip::detect
