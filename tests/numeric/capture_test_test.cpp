#include "core/detect/capture_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/model/threshold.hpp"
#include "tests/support/model_course.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::estimate {
namespace {

using test::ModelCourse;

constexpr double kNoise = 0.001;  // D/50, as in the shipped scenes
constexpr double kDeltaMu = ModelCourse::kS - ModelCourse::kK;

/// Log-likelihood ratio of captured over free for scans [first, end).
double log_likelihood_ratio(const Trace& trace, std::size_t first, std::size_t end,
                            const model::SharedParameters& shared, double sigma,
                            const detect::Budget& budget = {}) {
  CycleBuffer scans;
  read_slip(scans, trace, first, end, 2.0 * std::numbers::pi / shared.omega);
  detect::CaptureTest test;
  return test.evaluate(scans.points(), {shared, sigma, kDeltaMu}, budget).log_likelihood_ratio;
}

/// That of the first slip of the course: from the first maximum to the minimum after the second.
double of_first_slip(const ModelCourse& course, const Trace& trace, double sigma,
                     const detect::Budget& budget = {}) {
  const model::SlipModel model{course.shared, course.windows.front().slip, course.windows.front().captured};
  const double half_period_s = std::numbers::pi / course.shared.omega;
  const double peak_s = ModelCourse::kFirstOnset_s + model.waveform().peak_time_s();
  const double trough_s = course.windows.size() > 1
                              ? course.windows[1].slip.onset_s + model.waveform().trough_time_s()
                              : peak_s + 3.0 * half_period_s;
  const auto first = static_cast<std::size_t>(std::lround(peak_s * ModelCourse::kScanRate_Hz));
  const auto end = static_cast<std::size_t>(std::lround(trough_s * ModelCourse::kScanRate_Hz)) + 1;
  return log_likelihood_ratio(trace, first, std::min(end, trace.size()), course.shared, sigma, budget);
}

/// How many of n noisy repetitions are called captured.
int called_captured(const ModelCourse& course, int n) {
  int count = 0;
  for (int seed = 1; seed <= n; ++seed) {
    if (of_first_slip(course, course.noisy(kNoise, static_cast<std::uint64_t>(seed)), kNoise) > 0.0) ++count;
  }
  return count;
}

TEST(CaptureTest, SlipThatEndsInStickingIsCalledCaptured) {
  for (const double Q : {0.3, 0.65, 1.3})
    EXPECT_EQ(called_captured(ModelCourse::captured(Q, 2), 100), 100) << Q;
}

TEST(CaptureTest, OscillationThatGoesOnIsCalledFree) {
  for (const double Q : {2.6, 4.0, 8.0}) EXPECT_EQ(called_captured(ModelCourse::free(Q, 3.0), 100), 0) << Q;
}

/// Largest number of wrong signs in n tests that chance explains (one set of tests in 10⁶). With the mean Λ
/// of the exact trace a log-likelihood ratio is N(Λ, 2Λ), so that its sign is wrong in Φ(−√(Λ/2)) of the
/// tests.
double most_wrong(double mean, int n) {
  const double wrong = 0.5 * std::erfc(std::sqrt(std::abs(mean) / 2.0) / std::numbers::sqrt2);
  return test::highest_count(static_cast<double>(n), wrong, 1e-6);
}

TEST(CaptureTest, TellsTheSidesOfTheThresholdApart) {
  constexpr int kTests = 200;
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const ModelCourse below = ModelCourse::captured(0.9 * Q_th, 2);
  const ModelCourse above = ModelCourse::free(1.1 * Q_th, 3.0);
  EXPECT_LE(kTests - called_captured(below, kTests),
            most_wrong(of_first_slip(below, below.trace, kNoise), kTests));
  EXPECT_LE(called_captured(above, kTests), most_wrong(of_first_slip(above, above.trace, kNoise), kTests));
  EXPECT_GT(of_first_slip(below, below.trace, kNoise), 0.0);
  EXPECT_LT(of_first_slip(above, above.trace, kNoise), 0.0);
}

TEST(CaptureTest, ExactTracesAreToldApartOnePercentFromTheThreshold) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const ModelCourse below = ModelCourse::captured(0.99 * Q_th, 2);
  EXPECT_GT(of_first_slip(below, below.trace, 1e-5), 3.0);
  const ModelCourse above = ModelCourse::free(1.01 * Q_th, 3.0);
  EXPECT_LT(of_first_slip(above, above.trace, 1e-5), 0.0);
}

TEST(CaptureTest, ConvictionGrowsWithTheSquareOfSignalOverNoise) {
  // On an exact trace the ratio is the sum of squares of the other trajectory's best residuals over 2σ². A
  // residual z counts ln[(e^(−z²/2) + k)/(1 + k)] instead of −z²/2, with the density k of strays; up to z²/2
  // = 1 that bends its sum by k/2 of it at most.
  const ModelCourse course = ModelCourse::captured(1.3, 2);
  const double at_sigma = of_first_slip(course, course.trace, 0.04);
  EXPECT_GT(at_sigma, 0.0);
  EXPECT_NEAR(of_first_slip(course, course.trace, 0.02) / at_sigma, 4.0, 4.0 * detect::kStrayDensity / 2.0);
}

TEST(CaptureTest, TheFirstGuessIsALowerLimitOfCaptured) {
  for (const double Q : {0.3, 0.65, 1.3}) {
    const ModelCourse course = ModelCourse::captured(Q, 2);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Trace trace = course.noisy(kNoise, seed);
      const double bound =
          of_first_slip(course, trace, kNoise, {.enough = -std::numeric_limits<double>::infinity()});
      // Both rest on the same free oscillation; the fit ends within kCostConverged of its minimum.
      EXPECT_LE(bound, of_first_slip(course, trace, kNoise, {.iterations = 40}) + detect::kCostConverged)
          << Q << ' ' << seed;
      EXPECT_GT(bound, 3.0) << Q << ' ' << seed;
    }
  }
}

TEST(CaptureTest, AFirstGuessThatDoesNotSufficeIsImprovedAsAlways) {
  for (const ModelCourse& course : {ModelCourse::captured(1.3, 2), ModelCourse::free(2.6, 3.0)}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Trace trace = course.noisy(kNoise, seed);
      EXPECT_EQ(of_first_slip(course, trace, kNoise, {.enough = 1e9}), of_first_slip(course, trace, kNoise))
          << seed;
    }
  }
}

TEST(CaptureTest, SpikesThatWereNotFoundDoNotTurnTheVerdict) {
  // One scan of ten off by ten standard deviations to the same side, which is S − K/5.
  for (const bool captured : {true, false}) {
    const ModelCourse course = captured ? ModelCourse::captured(1.3, 2) : ModelCourse::free(2.6, 3.0);
    for (std::size_t phase = 0; phase < 10; ++phase) {
      Trace trace = course.noisy(kNoise, phase + 1);
      for (std::size_t k = phase; k < trace.size(); k += 10) trace.value[k] += 10.0 * kNoise;
      EXPECT_EQ(of_first_slip(course, trace, kNoise) > 0.0, captured) << phase;
    }
  }
}

TEST(CaptureTest, CaptureNeedsACredibleNextSlip) {
  // Just above the threshold a capture that slips at once, with S hardly above K, would look the same.
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const ModelCourse above = ModelCourse::free(1.003 * Q_th, 3.0);
  EXPECT_LT(of_first_slip(above, above.trace, kNoise), -std::log(20.0));
}

TEST(CaptureTest, FewerThanEightScansDecideNothing) {
  const ModelCourse course = ModelCourse::captured(1.3, 2);
  EXPECT_EQ(log_likelihood_ratio(course.trace, 20, 27, course.shared, kNoise), 0.0);
  Trace unusable = course.trace;
  unusable.usable.assign(unusable.size(), 0);
  EXPECT_EQ(log_likelihood_ratio(unusable, 20, unusable.size(), course.shared, kNoise), 0.0);
}

TEST(CaptureTest, ConstantTraceGivesANumber) {
  Trace trace = ModelCourse::free(2.6, 3.0).trace;
  trace.value.assign(trace.size(), 0.3);
  EXPECT_TRUE(std::isfinite(log_likelihood_ratio(trace, 20, 50, ModelCourse::tester_at(1.3), kNoise)));
}

}  // namespace
}  // namespace stickslip::estimate
