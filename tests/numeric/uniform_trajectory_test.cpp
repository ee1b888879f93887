#include "core/model/uniform_trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/estimate/information.hpp"
#include "tests/support/model_course.hpp"

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;
using test::ModelCourse;

model::UniformParameters paper_at(double Q) {
  return {ModelCourse::tester_at(Q), {ModelCourse::kFirstOnset_s, ModelCourse::kS, ModelCourse::kK}};
}

TEST(UniformTrajectory, IsTheChainOfStickAndSlip) {
  // The chain adds up one cycle after the other: 1e-16 s of rounding each, times a rate below 12/s.
  for (const double Q : {0.3, 1.3, 1.9}) {
    const ModelCourse chain = ModelCourse::captured(Q, 50);
    const auto course = model::UniformTrajectory::make(paper_at(Q));
    ASSERT_TRUE(course);
    for (std::size_t k = 0; k < chain.trace.size(); ++k) {
      ASSERT_NEAR(course->at(chain.trace.time_s[k]).value, chain.trace.value[k], 1e-13) << Q << ' ' << k;
    }
  }
}

/// Steps that turn the phase of the last cycle by less than 1e-3 rad or so.
constexpr std::array<double, 6> kSteps{1e-7, 1e-7, 1e-7, 1e-4, 1e-4, 1e-5};

/// Central differences with one step of Richardson's extrapolation.
P::Vector differences(const P& parameters, double time_s) {
  P::Vector result;
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const auto slope = [&](double step) {
      P::Vector up = parameters.vector();
      P::Vector down = parameters.vector();
      up[i] += step;
      down[i] -= step;
      return (model::UniformTrajectory::make(P::from(up))->at(time_s).value -
              model::UniformTrajectory::make(P::from(down))->at(time_s).value) /
             (2.0 * step);
    };
    const double step = kSteps[static_cast<std::size_t>(i)];
    result[i] = (4.0 * slope(step) - slope(2.0 * step)) / 3.0;
  }
  return result;
}

TEST(UniformTrajectory, SlopesAreThoseOfTheCourse) {
  // A difference over 2e-7 of values rounded to 6e-17 is right to 1e-9; what is left after the
  // extrapolation is of fourth order. Slopes in later cycles grow to the hundreds, hence relative.
  const P parameters = paper_at(1.3);
  const auto course = model::UniformTrajectory::make(parameters);
  const double T = course->period_s();
  P::Vector largest = P::Vector::Zero();
  std::vector<P::Vector> errors;
  for (int k = 0; k < 400; ++k) {
    const double time_s = 0.0013 * k;
    // c″ jumps at onset and capture: a difference across either is of first order only.
    const double since = std::remainder(time_s - parameters.slip.onset_s, T);
    const model::SlipModel slip{parameters.shared, parameters.slip, true};
    if (std::abs(since) < 1e-4 || std::abs(std::remainder(since - slip.capture_s(), T)) < 1e-4) continue;
    const P::Vector by = course->at(time_s).by;
    largest = largest.cwiseMax(by.cwiseAbs());
    errors.emplace_back((by - differences(parameters, time_s)).cwiseAbs());
  }
  for (const P::Vector& error : errors) {
    for (Eigen::Index i = 0; i < error.size(); ++i) EXPECT_LT(error[i], 2e-8 * largest[i]) << i;
  }
}

TEST(UniformTrajectory, ExistsOnlyWhereTheSledSticksAgain) {
  EXPECT_TRUE(model::UniformTrajectory::make(paper_at(1.93)));
  EXPECT_FALSE(model::UniformTrajectory::make(paper_at(1.95)));  // Q_threshold = 1.93871744784
  P turned = paper_at(1.3);
  std::swap(turned.slip.S, turned.slip.K);
  EXPECT_FALSE(model::UniformTrajectory::make(turned));
  P unknown = paper_at(1.3);
  unknown.shared.omega = std::nan("");
  EXPECT_FALSE(model::UniformTrajectory::make(unknown));
}

class Information : public testing::Test {
 protected:
  Information() : course_(*model::UniformTrajectory::make(parameters_)) {
    for (int k = 0; k < 200; ++k) times_s_.push_back(k / 350.0);
  }

  P parameters_ = paper_at(1.3);
  model::UniformTrajectory course_;
  std::vector<double> times_s_;
};

TEST_F(Information, BoundIsProportionalToTheNoise) {
  const UniformBounds one = cramer_rao_bounds(parameters_, fisher_information(course_, times_s_, 0.001), {});
  const UniformBounds two = cramer_rao_bounds(parameters_, fisher_information(course_, times_s_, 0.002), {});
  // The information's condition is some 1e10, so 1e-16 becomes 1e-6.
  EXPECT_NEAR(two.delta_mu / one.delta_mu, 2.0, 1e-5);
  EXPECT_NEAR(two.gamma_over_2omega / one.gamma_over_2omega, 2.0, 1e-5);
}

TEST_F(Information, OneNumberAloneIsTheMeanOfItsScans) {
  // Before the first onset, with all else known: the coefficient of n scans, σ/√n.
  const std::vector<double> stick(times_s_.begin(), times_s_.begin() + 18);
  const P::Matrix information = fisher_information(course_, stick, 0.001);
  EXPECT_NEAR(information(P::kS, P::kS), 18.0 / 1e-6, 1e-3);
  EXPECT_EQ(information(P::kK, P::kK), 0.0);
}

TEST_F(Information, WhatIsKnownBeforehandCountsLikeAMeasurement) {
  const P::Matrix scans = fisher_information(course_, times_s_, 0.001);
  const UniformBounds alone = cramer_rao_bounds(parameters_, scans, {});
  SharedPrior prior;
  const double omega = parameters_.shared.omega;
  const double ratio = parameters_.shared.gamma / (2.0 * omega);
  // As good as the test itself in γ/2ω, and hopeless in ω: the variance of γ/2ω halves.
  prior.coupling = {omega, ratio, Eigen::Matrix2d::Zero()};
  prior.coupling->covariance(0, 0) = 1e6;
  prior.coupling->covariance(1, 1) = alone.gamma_over_2omega * alone.gamma_over_2omega;
  const UniformBounds both = cramer_rao_bounds(parameters_, scans, prior);
  EXPECT_NEAR(both.gamma_over_2omega / alone.gamma_over_2omega, std::sqrt(0.5), 1e-5);
  EXPECT_LT(both.delta_mu, alone.delta_mu);
  // A speed known without error ties r to ω and γ: S − K cannot become less certain.
  prior = {};
  const auto oscillator = parameters_.shared.oscillator();
  const double speed = parameters_.shared.r / oscillator.omega0_squared();
  prior.belt = {speed, 1e-6 * speed};
  EXPECT_LT(cramer_rao_bounds(parameters_, scans, prior).omega, alone.omega);
}

TEST_F(Information, PriorPullsTowardsWhatItSays) {
  SharedPrior prior;
  const model::SharedParameters& shared = parameters_.shared;
  prior.coupling = {1.01 * shared.omega, 0.023, Eigen::Vector2d{1e-2, 1e-8}.asDiagonal()};
  prior.belt = {1.1 * shared.r / shared.oscillator().omega0_squared(), 1e-6};
  const PriorTerms terms = prior.at(shared);
  const auto cost = [&](double omega, double gamma, double r) { return prior.at({omega, gamma, r}).cost; };
  const std::array<double, 3> steps{1e-4, 1e-5, 1e-5};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto moved = [&](double by) {
      return cost(shared.omega + (i == 0 ? by : 0.0), shared.gamma + (i == 1 ? by : 0.0),
                  shared.r + (i == 2 ? by : 0.0));
    };
    const double slope = (moved(steps[i]) - moved(-steps[i])) / (2.0 * steps[i]);
    EXPECT_NEAR(terms.gradient[static_cast<Eigen::Index>(i)], -slope, 1e-5 * std::abs(slope)) << i;
  }
}

}  // namespace
}  // namespace stickslip::estimate
