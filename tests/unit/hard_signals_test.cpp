// Signals that laboratories do deliver: at the rails, of a few steps, far from zero, undersampled, with
// spikes, hum, gaps and scatter. Each gets results that are right within their errors, or a reason.

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "core/signal/statistics.hpp"
#include "tests/support/model_course.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip::model {
namespace {

constexpr double kRate_Hz = 350.0;
constexpr double kD = test::ModelCourse::kS - test::ModelCourse::kK;
constexpr double kQ = 1.0;  // Half the threshold.

/// One scan of a test.
struct Scan {
  base::ScanIndex index = 0;
  double value = 0.0;
  bool saturated = false;
};

/// A rest of 0.2 s, the loading, and slips with these S − K about K that falls, each ending in sticking.
class Pull {
 public:
  explicit Pull(std::vector<double> delta_mu, double drift_per_s = 0.0) : drift_per_s_(drift_per_s) {
    double onset_s = kRest_s + test::ModelCourse::kS / shared_.r;
    begin_s_ = kRest_s;
    for (std::size_t i = 0; i < delta_mu.size(); ++i) {
      const double K = test::ModelCourse::kK;
      slips_.push_back({onset_s, K + delta_mu[i], K});
      models_.emplace_back(shared_, slips_.back(), true);
      const double capture_s = onset_s + models_.back().capture_s();
      const double next = delta_mu[i + 1 < delta_mu.size() ? i + 1 : i];
      onset_s = capture_s + (K + next - models_.back().at(capture_s).value) / shared_.r;
    }
    end_s_ = onset_s;
  }

  /// Without noise. \param time_s  after the first scan.
  [[nodiscard]] double at(double time_s) const {
    if (time_s < begin_s_) return 0.0;
    std::size_t i = 0;
    while (i + 1 < slips_.size()) {
      const double capture_s = slips_[i].onset_s + models_[i].capture_s();
      if (time_s < 0.5 * (capture_s + slips_[i + 1].onset_s)) break;
      ++i;
    }
    return std::max(0.0, models_[i].at(time_s).value - drift_per_s_ * (time_s - begin_s_));
  }

  /// With white noise.
  [[nodiscard]] std::vector<Scan> scans(double sigma, std::uint64_t seed, double rate_Hz = kRate_Hz) const {
    std::mt19937_64 engine{seed};
    std::normal_distribution<double> normal;
    std::vector<Scan> result;
    for (base::ScanIndex k = 0; static_cast<double>(k) < end_s_ * rate_Hz; ++k) {
      result.push_back({k, at(static_cast<double>(k) / rate_Hz) + sigma * normal(engine), false});
    }
    return result;
  }

  [[nodiscard]] const std::vector<SlipParameters>& slips() const noexcept { return slips_; }
  [[nodiscard]] const SlipModel& model(std::size_t i) const { return models_[i]; }
  [[nodiscard]] double frequency_Hz() const {
    return static_cast<double>(slips_.size() - 1) / (slips_.back().onset_s - slips_.front().onset_s);
  }

 private:
  static constexpr double kRest_s = 0.2;
  SharedParameters shared_ = test::ModelCourse::tester_at(kQ);
  double drift_per_s_;
  double begin_s_ = 0.0;
  double end_s_ = 0.0;
  std::vector<SlipParameters> slips_;
  std::vector<SlipModel> models_;
};

constexpr int kSlips = 30;
Pull regular() { return Pull{std::vector<double>(kSlips, kD)}; }

struct Analysed {
  analysis::TestResults results;
  std::vector<detect::Cycle> cycles;
};

Analysed analysed(const std::vector<Scan>& scans, double rate_Hz = kRate_Hz, double step = 0.0) {
  analysis::AnalysisSettings settings;
  settings.scan_rate_Hz = rate_Hz;
  settings.step_coefficient = step;
  analysis::TestAnalysis analysis{settings};
  base::ScanIndex next = scans.front().index;
  for (const Scan& scan : scans) {
    if (scan.index != next) analysis.gap(next, scan.index - next);
    analysis.add(scan.index, scan.value, scan.saturated);
    next = scan.index + 1;
  }
  Analysed result{analysis.finish(), {}};
  result.cycles.assign(analysis.cycles().begin(), analysis.cycles().end());
  analysis::for_each_result(result.results,
                            [](const analysis::ResultName& name, const analysis::Estimate& estimate) {
                              EXPECT_NE(estimate.value.has_value(), !estimate.reason.empty()) << name.name;
                              EXPECT_TRUE(std::isfinite(estimate.value.value_or(0.0))) << name.name;
                              EXPECT_TRUE(std::isfinite(estimate.standard_error.value_or(0.0))) << name.name;
                            });
  return result;
}

/// Five standard errors: once in two million.
void expect_true(const analysis::Estimate& estimate, double truth) {
  ASSERT_TRUE(estimate.value) << estimate.reason;
  EXPECT_NEAR(*estimate.value, truth, 5.0 * *estimate.standard_error);
}

void expect_true_or_absent(const analysis::Estimate& estimate, double truth) {
  if (estimate.value) expect_true(estimate, truth);
}

constexpr double kSigma = 0.001;

TEST(HardSignals, RailsAreFlaggedAndLeftOut) {
  std::vector<Scan> scans = regular().scans(kSigma, 11);
  const double top = 0.36;  // The peaks reach 0.37, the troughs 0.23.
  const double bottom = 0.24;
  for (Scan& scan : scans) {
    const bool high = scan.value >= top;
    const bool low = scan.index > 100 && scan.value <= bottom;
    scan.saturated = high || low;
    if (high) scan.value = top;
    if (low) scan.value = bottom;
  }
  const Analysed clipped = analysed(scans);
  EXPECT_NEAR(static_cast<double>(clipped.cycles.size()), kSlips, 1.0);
  for (const detect::Cycle& cycle : clipped.cycles)
    EXPECT_NE(cycle.flags & detect::kCycleIsSaturated, 0) << cycle.number;
  expect_true_or_absent(clipped.results.delta_mu, kD);
  expect_true_or_absent(clipped.results.mu_k, test::ModelCourse::kK);

  for (Scan& scan : scans) {
    scan.saturated = true;
    scan.value = scan.index % 40 < 20 ? top : bottom;
  }
  const Analysed all = analysed(scans);
  EXPECT_FALSE(all.results.delta_mu.value);
  EXPECT_FALSE(all.results.omega.value);
}

TEST(HardSignals, AmplitudeOfOneToThreeSteps) {
  const double amplitude = kD * std::hypot(1.0, kQ);
  for (const int steps : {1, 2, 3}) {
    const double step = amplitude / steps;
    std::vector<Scan> scans = regular().scans(kSigma, 11);
    for (Scan& scan : scans) scan.value = step * std::round(scan.value / step);
    const Analysed coarse = analysed(scans, kRate_Hz, step);
    // Never one more than there are. Where rounding is most of the signal its noise is more than step/√12;
    // three steps up and three down are far enough above it.
    EXPECT_LE(coarse.cycles.size(), static_cast<std::size_t>(kSlips)) << steps;
    if (steps == 3) {
      EXPECT_GE(coarse.cycles.size(), static_cast<std::size_t>(kSlips - 2));
    }
    if (coarse.results.oscillation_frequency.value &&
        coarse.cycles.size() + 2 >= static_cast<std::size_t>(kSlips)) {
      EXPECT_NEAR(*coarse.results.oscillation_frequency.value / regular().frequency_Hz(), 1.0, 0.01) << steps;
    }
    // Rounding of so few steps is no white noise: S − K within a step.
    if (coarse.results.delta_mu.value) {
      EXPECT_NEAR(*coarse.results.delta_mu.value, kD, step) << steps;
    }
  }
}

TEST(HardSignals, OffsetOfAMillionAmplitudes) {
  std::vector<Scan> scans = regular().scans(kSigma, 12);
  const Analysed plain = analysed(scans);
  const double offset = 1e6 * kD;
  for (Scan& scan : scans) scan.value += offset;
  const Analysed moved = analysed(scans);
  ASSERT_EQ(moved.cycles.size(), plain.cycles.size());
  // Values near 5 · 10⁴ are rounded to 7 · 10⁻¹².
  for (std::size_t i = 0; i < plain.cycles.size(); ++i) {
    EXPECT_NEAR(moved.cycles[i].force_drop, plain.cycles[i].force_drop, 1e-10) << i;
  }
  expect_true(plain.results.delta_mu, kD);
  expect_true_or_absent(moved.results.delta_mu, kD);
}

TEST(HardSignals, DenormalsAreAnswered) {
  std::vector<Scan> scans = regular().scans(kSigma, 13);
  for (Scan& scan : scans) scan.value = std::ldexp(scan.value, -1060);
  const Analysed tiny = analysed(scans);
  EXPECT_LE(tiny.cycles.size(), static_cast<std::size_t>(kSlips));
  for (Scan& scan : scans)
    scan.value = std::numeric_limits<double>::denorm_min() * static_cast<double>(scan.index % 3);
  EXPECT_EQ(analysed(scans).cycles.size(), 0U);
}

TEST(HardSignals, ThreeToFourScansACycleHaveLargerErrors) {
  const Pull pull{std::vector<double>(100, kD)};
  const Analysed fine = analysed(pull.scans(kSigma, 14));
  expect_true(fine.results.delta_mu, kD);
  for (const double scans_a_cycle : {3.1, 3.5, 4.0}) {
    const double rate_Hz = scans_a_cycle * pull.frequency_Hz();
    const Analysed coarse = analysed(pull.scans(kSigma, 14, rate_Hz), rate_Hz);
    EXPECT_LE(coarse.cycles.size(), 100U) << scans_a_cycle;
    if (!coarse.results.delta_mu.value) continue;
    expect_true(coarse.results.delta_mu, kD);
    EXPECT_GT(*coarse.results.delta_mu.standard_error, *fine.results.delta_mu.standard_error)
        << scans_a_cycle;
  }
}

TEST(HardSignals, AnOscillationOfFewScansACycleIsNeverSteadySliding) {
  const Pull pull{std::vector<double>(100, kD)};
  for (const double scans_a_cycle : {3.1, 3.5, 4.0, 4.6, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5}) {
    const double rate_Hz = scans_a_cycle * pull.frequency_Hz();
    const Analysed coarse = analysed(pull.scans(kSigma, 14, rate_Hz), rate_Hz);
    EXPECT_NE(coarse.results.regime, Regime::kSteadySliding) << scans_a_cycle;
    if (coarse.cycles.empty()) {
      EXPECT_THAT(coarse.results.regime_reason, testing::HasSubstr("scan more often")) << scans_a_cycle;
      EXPECT_FALSE(coarse.results.cycle_count.value) << scans_a_cycle;
    } else {
      EXPECT_THAT(base::texts_of(coarse.results.findings),
                  testing::Contains(testing::HasSubstr("scans a cycle")))
          << scans_a_cycle;
    }
  }
}

TEST(HardSignals, SpikesOnPeaksAndInPairs) {
  const Pull pull = regular();
  const std::vector<Scan> clean = pull.scans(kSigma, 15);
  const Analysed without = analysed(clean);
  std::vector<Scan> scans = clean;
  for (std::size_t i = 3; i < 27; i += 4) {
    const double peak_s = pull.slips()[i].onset_s + pull.model(i).waveform().peak_time_s();
    const auto at = static_cast<std::size_t>(std::lround(peak_s * kRate_Hz));
    scans[at].value += 0.2;
    if (i % 8 == 3) scans[at + 1].value += 0.15;  // Two in a row.
  }
  const Analysed with = analysed(scans);
  ASSERT_EQ(with.cycles.size(), without.cycles.size());
  expect_true(with.results.delta_mu, kD);
  EXPECT_EQ(with.results.regime, Regime::kStickSlip) << with.results.regime_reason;

  scans = clean;
  scans.front().value += 0.3;
  scans.back().value += 0.3;
  const Analysed ends = analysed(scans);
  EXPECT_NEAR(static_cast<double>(ends.cycles.size()), static_cast<double>(without.cycles.size()), 1.0);
  expect_true(ends.results.delta_mu, kD);
}

TEST(HardSignals, TwentyFourSpikesASecond) {
  std::mt19937_64 engine{16};
  std::exponential_distribution<double> size{1.0 / kD};
  std::bernoulli_distribution hit{24.0 / kRate_Hz};
  std::vector<Scan> scans = regular().scans(kSigma, 16);
  for (Scan& scan : scans) {
    if (hit(engine)) scan.value += engine() % 2 == 0 ? size(engine) : -size(engine);
  }
  const Analysed spiky = analysed(scans);
  EXPECT_NEAR(static_cast<double>(spiky.cycles.size()), kSlips - 1, 2.0);
  EXPECT_NE(spiky.results.regime, Regime::kRingDown) << spiky.results.regime_reason;
  expect_true_or_absent(spiky.results.delta_mu, kD);
}

TEST(HardSignals, HumOfHalfTheAmplitudeGivesNoWrongRegime) {
  for (const double hum_Hz : {50.0, 60.0}) {
    std::vector<Scan> scans = regular().scans(kSigma, 17);
    const double amplitude = 0.5 * kD * std::hypot(1.0, kQ);
    for (Scan& scan : scans) {
      scan.value +=
          amplitude * std::sin(2.0 * std::numbers::pi * hum_Hz * static_cast<double>(scan.index) / kRate_Hz);
    }
    const Analysed humming = analysed(scans);
    EXPECT_NE(humming.results.regime, Regime::kSteadySliding) << hum_Hz;
    EXPECT_NE(humming.results.regime, Regime::kRingDown) << hum_Hz << humming.results.regime_reason;
    // The model has no hum: a finding says that S − K is by turning points, and its uncertainty covers the
    // truth.
    ASSERT_TRUE(humming.results.delta_mu.value) << humming.results.delta_mu.reason;
    const analysis::Estimate& found = humming.results.delta_mu;
    EXPECT_NEAR(*found.value, kD, *found.systematic_uncertainty + 2.0 * *found.standard_error) << hum_Hz;
    ASSERT_FALSE(humming.results.findings.empty());
    EXPECT_NE(humming.results.findings.front().text.find("by turning points"), std::string::npos);
  }
}

TEST(HardSignals, GapsInASlipAStickAndOverATransition) {
  constexpr int kMany = 60;  // 3.6 s, of which 1000 scans are 2.9.
  const Pull pull{std::vector<double>(kMany, kD)};
  constexpr std::size_t kHit = 32;
  const double onset_s = pull.slips()[kHit].onset_s;
  const double capture_s = onset_s + pull.model(kHit).capture_s();
  for (const base::ScanIndex length : {1, 10, 1000}) {
    for (const double at_s : {onset_s + 0.01, capture_s + 0.005, onset_s, capture_s}) {
      const auto first = static_cast<base::ScanIndex>(at_s * kRate_Hz) - (length == 1 ? 0 : length / 2);
      std::vector<Scan> scans;
      for (const Scan& scan : pull.scans(kSigma, 18)) {
        if (scan.index < first || scan.index >= first + length) scans.push_back(scan);
      }
      const Analysed holed = analysed(scans);
      SCOPED_TRACE(testing::Message() << length << " scans at " << at_s);
      EXPECT_EQ(holed.results.gap_count.value, 1.0);
      EXPECT_EQ(holed.results.lost_scan_count.value, static_cast<double>(length));
      // So many slips may have fallen in, and one on either side.
      const double slips_lost = static_cast<double>(length) / kRate_Hz * pull.frequency_Hz();
      EXPECT_LE(holed.cycles.size(), static_cast<std::size_t>(kMany));
      EXPECT_GE(static_cast<double>(holed.cycles.size()), kMany - 3.0 - std::ceil(slips_lost));
      expect_true_or_absent(holed.results.delta_mu, kD);
      if (length == 1) expect_true(holed.results.delta_mu, kD);
    }
  }
}

TEST(HardSignals, RateOffByAThousandPpmMovesTheTimesAndNothingElse) {
  const std::vector<Scan> scans = regular().scans(kSigma, 19);
  const Analysed right = analysed(scans);
  for (const double off : {-1e-3, 1e-3}) {
    const Analysed wrong = analysed(scans, kRate_Hz * (1.0 + off));
    ASSERT_TRUE(wrong.results.omega.value && right.results.omega.value);
    // The fits stop where the cost is flat: a part √(1e-10) of the standard errors, for some hundred scans.
    const auto near = [](const analysis::Estimate& a, double b) {
      EXPECT_NEAR(*a.value, b, 1e-3 * *a.standard_error);
    };
    near(wrong.results.omega, *right.results.omega.value * (1.0 + off));
    near(wrong.results.delta_mu, *right.results.delta_mu.value);
    near(wrong.results.gamma_over_2omega, *right.results.gamma_over_2omega.value);
    EXPECT_EQ(wrong.results.cycle_count, right.results.cycle_count);
  }
}

TEST(HardSignals, HalfScatterAndAFastDrift) {
  // S − K log-normal with 50 % about the mean, kept where each slip sticks again (Q of the smallest 1.9).
  std::mt19937_64 engine{20};
  const double log_sd = std::sqrt(std::log1p(0.25));
  std::normal_distribution<double> normal{-0.5 * log_sd * log_sd, log_sd};
  std::vector<double> delta_mu;
  while (delta_mu.size() < 24) {  // 1.5 s: K falls to one half.
    const double D = 1.5 * kD * std::exp(normal(engine));
    if (D > 0.7 * kD) delta_mu.push_back(D);
  }
  const Analysed scattered = analysed(Pull{delta_mu, 0.1}.scans(kSigma, 20));
  EXPECT_NEAR(static_cast<double>(scattered.cycles.size()), 24.0, 2.0);
  signal::RunningMean mean;
  for (const double D : delta_mu) mean.add(D);
  // The sample itself is the truth: the fit's error of a slip, not the scatter, is what remains; a slip more
  // or less in the mean changes it by up to the scatter over the number of slips.
  ASSERT_TRUE(scattered.results.delta_mu.value) << scattered.results.delta_mu.reason;
  EXPECT_NEAR(*scattered.results.delta_mu.value, mean.mean, *scattered.results.delta_mu.standard_error);
  ASSERT_TRUE(scattered.results.drift_rate.value);
  EXPECT_NEAR(*scattered.results.drift_rate.value, -0.1, 5.0 * *scattered.results.drift_rate.standard_error);
}

TEST(HardSignals, BeatsThroughZeroAreAnswered) {
  std::mt19937_64 engine{21};
  std::normal_distribution<double> normal{0.0, kSigma};
  std::vector<Scan> scans;
  for (base::ScanIndex k = 0; k < 1400; ++k) {
    const double time_s = static_cast<double>(k) / kRate_Hz;
    const double beat = std::cos(2.0 * std::numbers::pi * 0.7 * time_s);
    const double wave = std::sin(2.0 * std::numbers::pi * 18.0 * time_s);
    scans.push_back({k, 0.05 + 0.06 * beat * wave + normal(engine), false});
  }
  const Analysed beating = analysed(scans);
  EXPECT_LE(beating.cycles.size(), 72U);  // 4 s at 18 Hz.
  EXPECT_NE(beating.results.regime, Regime::kRingDown) << beating.results.regime_reason;
}

TEST(HardSignals, MeanOfADayOfScansKeepsTwelveDigits) {
  // 3 · 10⁷ scans whose sum is known as a whole number of 2⁻³⁰. The recursion adds (x − mean)/n, rounded:
  // with steps of ε/2 · mean each, of either sign, √n · ε; were they all one way, ε ln n and less.
  const std::int64_t count = test::kSanitized ? 3'000'000 : 30'000'000;
  signal::RunningMean mean;
  std::int64_t sum = 0;
  std::uint64_t state = 1;
  for (std::int64_t k = 0; k < count; ++k) {
    state = state * 6364136223846793005U + 1442695040888963407U;  // [Knuth, TAOCP vol. 2, 3.3.4]
    const std::int64_t units = 322122547 + static_cast<std::int64_t>(state >> 36U) - k;
    sum += units;
    mean.add(std::ldexp(static_cast<double>(units), -30));
  }
  const double exact = std::ldexp(static_cast<double>(sum) / static_cast<double>(count), -30);
  EXPECT_NEAR(mean.mean / exact, 1.0, 1e-12);
  EXPECT_EQ(mean.count, static_cast<double>(count));
}

}  // namespace
}  // namespace stickslip::model
