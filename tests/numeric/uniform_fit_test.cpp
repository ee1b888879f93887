#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/estimate/uniform_stage.hpp"
#include "tests/support/model_course.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::estimate {
namespace {

using test::ModelCourse;

constexpr double kUniformSigma = 0.001;

TEST(UniformFit, GivesBackTheParametersOfAnExactTrace) {
  // As SlipFit: it stops where a step lowers the cost by less than 1e-10 of it, and converges quadratically.
  const ModelCourse course = ModelCourse::captured(1.3, 10);
  model::UniformParameters guess{course.shared, course.windows.front().slip};
  guess.slip.S += 0.002;
  guess.slip.K -= 0.001;
  guess.shared.omega *= 1.001;
  guess.shared.gamma *= 0.9;
  const UniformFit fit = fit_uniform(course.trace, 0, course.trace.size(), guess, kUniformSigma, {});
  ASSERT_TRUE(fit.converged);
  EXPECT_NEAR(fit.parameters.slip.S, ModelCourse::kS, 1e-8);
  EXPECT_NEAR(fit.parameters.slip.K, ModelCourse::kK, 1e-8);
  EXPECT_NEAR(fit.parameters.shared.gamma / course.shared.gamma, 1.0, 1e-6);
  EXPECT_NEAR(fit.parameters.shared.omega / course.shared.omega, 1.0, 1e-8);
  EXPECT_EQ(fit.scan_count, static_cast<double>(course.trace.size()));
}

TEST(UniformFit, SaysSoWhereScansAreFewOrTellNothing) {
  const ModelCourse course = ModelCourse::captured(1.3, 10);
  const model::UniformParameters truth{course.shared, course.windows.front().slip};
  // Six numbers from none to six scans, and from a stick alone, where K, omega and gamma leave no trace.
  for (const std::size_t end : {0U, 1U, 3U, 5U, 6U, 15U}) {
    const UniformFit fit = fit_uniform(course.noisy(kUniformSigma, 1), 0, end, truth, kUniformSigma, {});
    if (!fit.converged) continue;
    EXPECT_TRUE(fit.covariance.allFinite()) << end;
    // What the scans do not tell must not be claimed: K to better than S - K.
    EXPECT_GT(std::sqrt(fit.covariance(model::UniformParameters::kK, model::UniformParameters::kK)),
              ModelCourse::kS - ModelCourse::kK)
        << end;
  }
  // From a bad guess: an end, with or without convergence, and finite numbers.
  model::UniformParameters bad = truth;
  bad.shared.omega *= 3.0;
  bad.slip.S += 1.0;
  const UniformFit far = fit_uniform(course.trace, 0, course.trace.size(), bad, kUniformSigma, {});
  EXPECT_TRUE(far.parameters.vector().allFinite());
}

std::optional<UniformFit> stage(const Trace& trace, std::vector<SlipWindow> windows,
                                const ModelCourse& course) {
  const SlipFit fit = fit_slips(trace, windows, course.shared, kUniformSigma);
  return fit.converged ? uniform_if_slips_agree(trace, windows, fit.shared, kUniformSigma, {}) : std::nullopt;
}

TEST(UniformStage, TakesEqualSlipsAsEqualAtItsLevel) {
  // One in a hundred is refused.
  constexpr int kSeeds = 300;
  const ModelCourse course = ModelCourse::captured(1.3, 11);
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    if (!stage(course.noisy(kUniformSigma, seed), course.windows, course)) ++refused;
  }
  EXPECT_LE(refused, test::highest_count(kSeeds, 0.01));
}

TEST(UniformStage, HundredsOfSlipsKeepTheirPhase) {
  const ModelCourse course = ModelCourse::captured(1.3, 400);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto uniform = stage(course.noisy(kUniformSigma, seed), course.windows, course);
    if (!uniform) continue;
    ++found;
    EXPECT_NEAR(
        uniform->parameters.slip.S, ModelCourse::kS,
        5.0 * std::sqrt(uniform->covariance(model::UniformParameters::kS, model::UniformParameters::kS)));
  }
  EXPECT_GE(found, 9);
}

TEST(UniformStage, SlipsThatDifferKeepTheirOwn) {
  // One K of eleven off by 2 % of K: 6 σ in every one of some twelve scans of its slip.
  const ModelCourse course = ModelCourse::captured(1.3, 11);
  Trace trace = course.noisy(kUniformSigma, 1);
  for (std::size_t k = course.windows[5].first; k < course.windows[5].end; ++k) trace.value[k] += 0.006;
  EXPECT_FALSE(stage(trace, course.windows, course));
}

TEST(UniformStage, NeedsThreeSlipsThatStickAgain) {
  const ModelCourse two = ModelCourse::captured(1.3, 2);
  EXPECT_FALSE(stage(two.noisy(kUniformSigma, 1), two.windows, two));
  ModelCourse free = ModelCourse::captured(1.3, 5);
  free.windows[3].captured = false;
  EXPECT_FALSE(stage(free.noisy(kUniformSigma, 1), free.windows, free));
}

}  // namespace
}  // namespace stickslip::estimate
