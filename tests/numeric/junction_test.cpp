#include "core/detect/junction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/model/threshold.hpp"
#include "tests/support/model_course.hpp"

namespace stickslip::estimate {
namespace {

using test::ModelCourse;

constexpr double kJunctionSigma = 0.001;  // D/50, as in the shipped scenes
constexpr double kDeltaMu = ModelCourse::kS - ModelCourse::kK;

/// Ratio for the first junction of the course: from the first maximum to the minimum after the second.
double first_junction(const ModelCourse& course, const Trace& trace, double sigma) {
  const model::SlipModel model{course.shared, course.windows.front().slip, course.windows.front().captured};
  const double half_period_s = std::numbers::pi / course.shared.omega;
  const double peak_s = ModelCourse::kFirstOnset_s + model.waveform().peak_time_s();
  const double trough_s = course.windows.size() > 1
                              ? course.windows[1].slip.onset_s + model.waveform().trough_time_s()
                              : peak_s + 3.0 * half_period_s;
  const auto first = static_cast<std::size_t>(std::lround(peak_s * ModelCourse::kScanRate_Hz));
  const auto end = static_cast<std::size_t>(std::lround(trough_s * ModelCourse::kScanRate_Hz)) + 1;
  return detect::capture_log_likelihood_ratio(trace, first, std::min(end, trace.size()), course.shared, sigma,
                                              kDeltaMu);
}

/// How many of n noisy repetitions are called captured.
int called_captured(const ModelCourse& course, int n) {
  int count = 0;
  for (int seed = 1; seed <= n; ++seed) {
    if (first_junction(course, course.noisy(kJunctionSigma, static_cast<std::uint64_t>(seed)),
                       kJunctionSigma) > 0.0)
      ++count;
  }
  return count;
}

TEST(Junction, SlipThatEndsInStickingIsCalledCaptured) {
  for (const double Q : {0.3, 0.65, 1.3})
    EXPECT_EQ(called_captured(ModelCourse::captured(Q, 2), 100), 100) << Q;
}

TEST(Junction, OscillationThatGoesOnIsCalledFree) {
  for (const double Q : {2.6, 4.0, 8.0}) EXPECT_EQ(called_captured(ModelCourse::free(Q, 3.0), 100), 0) << Q;
}

TEST(Junction, TellsTheSidesOfTheThresholdApart) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const int below = called_captured(ModelCourse::captured(0.9 * Q_th, 2), 200);
  const int above = called_captured(ModelCourse::free(1.1 * Q_th, 3.0), 200);
  RecordProperty("captured_below", below);
  RecordProperty("captured_above", above);
  EXPECT_GE(below, 190);
  EXPECT_LE(above, 10);
}

TEST(Junction, ExactTracesAreToldApartOnePercentFromTheThreshold) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const ModelCourse below = ModelCourse::captured(0.99 * Q_th, 2);
  EXPECT_GT(first_junction(below, below.trace, 1e-5), 3.0);
  const ModelCourse above = ModelCourse::free(1.01 * Q_th, 3.0);
  EXPECT_LT(first_junction(above, above.trace, 1e-5), 0.0);
}

TEST(Junction, ConvictionGrowsWithTheSquareOfSignalOverNoise) {
  // On an exact trace the ratio is the sum of squares of the other course's best residuals over 2σ², as long
  // as all of them lie within Huber's limit: here within 1.345 · 0.02, half of S − K.
  const ModelCourse course = ModelCourse::captured(1.3, 2);
  const double at_sigma = first_junction(course, course.trace, 0.04);
  EXPECT_GT(at_sigma, 0.0);
  // Both fits stop at changes of 1e-6 of a log-likelihood.
  EXPECT_NEAR(first_junction(course, course.trace, 0.02) / at_sigma, 4.0, 1e-6 * 8.0 / at_sigma);
}

TEST(Junction, SpikesThatWereNotFoundDoNotTurnTheVerdict) {
  // One scan of ten off by ten standard deviations to the same side, which is S − K/5.
  for (const bool captured : {true, false}) {
    const ModelCourse course = captured ? ModelCourse::captured(1.3, 2) : ModelCourse::free(2.6, 3.0);
    for (std::size_t phase = 0; phase < 10; ++phase) {
      Trace trace = course.noisy(kJunctionSigma, phase + 1);
      for (std::size_t k = phase; k < trace.size(); k += 10) trace.value[k] += 10.0 * kJunctionSigma;
      EXPECT_EQ(first_junction(course, trace, kJunctionSigma) > 0.0, captured) << phase;
    }
  }
}

TEST(Junction, CaptureNeedsACredibleNextSlip) {
  // Just above the threshold a capture that slips at once, with S hardly above K, would look the same.
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  const ModelCourse above = ModelCourse::free(1.003 * Q_th, 3.0);
  EXPECT_LT(first_junction(above, above.trace, kJunctionSigma), -std::log(20.0));
}

TEST(Junction, FewerThanEightScansDecideNothing) {
  const ModelCourse course = ModelCourse::captured(1.3, 2);
  EXPECT_EQ(
      detect::capture_log_likelihood_ratio(course.trace, 20, 27, course.shared, kJunctionSigma, kDeltaMu),
      0.0);
  Trace unusable = course.trace;
  unusable.usable.assign(unusable.size(), 0);
  EXPECT_EQ(detect::capture_log_likelihood_ratio(unusable, 20, unusable.size(), course.shared, kJunctionSigma,
                                                 kDeltaMu),
            0.0);
}

TEST(Junction, ConstantTraceGivesANumber) {
  Trace trace = ModelCourse::free(2.6, 3.0).trace;
  trace.value.assign(trace.size(), 0.3);
  EXPECT_TRUE(std::isfinite(detect::capture_log_likelihood_ratio(trace, 20, 50, ModelCourse::tester_at(1.3),
                                                                 kJunctionSigma, kDeltaMu)));
}

}  // namespace
}  // namespace stickslip::estimate
