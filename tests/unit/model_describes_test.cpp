// Whether the model describes a test, asked of estimates that are made by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/analysis/model_results.hpp"
#include "core/estimate/huber.hpp"
#include "core/model/threshold.hpp"

namespace stickslip::analysis {
namespace {

constexpr double kScanSigma = 0.001;
constexpr double kOmega = 40.0 * std::numbers::pi;
constexpr double kGammaOver2Omega = 0.022;
constexpr double kS_minus_K = 0.05;

/// Relative standard errors; small ones unless a test is about them.
struct Certainty {
  double gamma = 1e-9;
  double r = 1e-9;
  double delta_mu = 1e-9;
};

struct Slip {
  SlipEnd end;
  double log_likelihood_ratio;
};
constexpr Slip kSurelyFree{SlipEnd::kFree, -50.0};
constexpr Slip kSurelyCaptured{SlipEnd::kCaptured, 50.0};
constexpr Slip kLast{SlipEnd::kUnknown, 0.0};

/// Slips of a test with Q = `part` · Q_th. A slip after a free one shares its window.
SlipEstimates estimates_of(double part, const std::vector<Slip>& slips, const Certainty& certainty = {}) {
  SlipEstimates estimates;
  estimate::SlipFit& fit = estimates.fit;
  fit.converged = true;
  fit.residual_sigma = kScanSigma;
  const double gamma = 2.0 * kGammaOver2Omega * kOmega;
  fit.shared = {kOmega, gamma, part * model::Q_threshold(kGammaOver2Omega) * kOmega * kS_minus_K};
  fit.shared_covariance(1, 1) = std::pow(certainty.gamma * gamma, 2);
  fit.shared_covariance(2, 2) = std::pow(certainty.r * fit.shared.r, 2);
  for (std::size_t i = 0; i < slips.size(); ++i) {
    if (i == 0 || slips[i - 1].end == SlipEnd::kCaptured) {
      estimate::SlipWindow window;
      window.slip = {0.1 * static_cast<double>(i), 0.3 + kS_minus_K, 0.3};
      window.inverse_curvature(1, 1) = std::pow(certainty.delta_mu * kS_minus_K, 2);
      estimates.windows.push_back(window);
    }
    estimates.window_of_slip.push_back(estimates.windows.size() - 1);
    estimates.ends.push_back(slips[i].end);
    if (i + 1 < slips.size()) estimates.log_likelihood_ratios.push_back(slips[i].log_likelihood_ratio);
  }
  return estimates;
}

bool describes(const SlipEstimates& estimates) { return model_describes(estimates, kScanSigma); }

// Below the threshold the sled sticks again, above it goes on [22]; the model leaves out a fifth of Q.
TEST(ModelDescribes, EndOfASlipAgreesWithItsQ) {
  EXPECT_FALSE(describes(estimates_of(0.99 / 1.2, {kSurelyFree, kLast})));
  EXPECT_TRUE(describes(estimates_of(1.01 / 1.2, {kSurelyFree, kLast})));
  EXPECT_TRUE(describes(estimates_of(0.99 * 1.2, {kSurelyCaptured, kLast})));
  EXPECT_FALSE(describes(estimates_of(1.01 * 1.2, {kSurelyCaptured, kLast})));
  EXPECT_TRUE(describes(estimates_of(0.5, {kSurelyCaptured, kLast})));
  EXPECT_TRUE(describes(estimates_of(2.0, {kSurelyFree, kLast})));
}

// r and S − K make Q uncertain, together by √(0.06² + 0.08²) = 0.1, and three standard errors are allowed.
TEST(ModelDescribes, ThreeStandardErrorsOfQAreAllowed) {
  const Certainty certainty{.r = 0.06, .delta_mu = 0.08};
  EXPECT_TRUE(describes(estimates_of(1.01 / (1.2 * 1.3), {kSurelyFree, kLast}, certainty)));
  EXPECT_FALSE(describes(estimates_of(0.99 / (1.2 * 1.3), {kSurelyFree, kLast}, certainty)));
  EXPECT_TRUE(describes(estimates_of(0.99 * 1.2 * 1.3, {kSurelyCaptured, kLast}, certainty)));
  EXPECT_FALSE(describes(estimates_of(1.01 * 1.2 * 1.3, {kSurelyCaptured, kLast}, certainty)));
}

TEST(ModelDescribes, ThreeStandardErrorsOfTheDampingAreAllowed) {
  const Certainty certainty{.gamma = 0.1};
  const double usual = model::Q_threshold(kGammaOver2Omega);
  const double lowest = model::Q_threshold(1.3 * kGammaOver2Omega) / usual;
  const double highest = model::Q_threshold(0.7 * kGammaOver2Omega) / usual;
  EXPECT_FALSE(describes(estimates_of(0.99 * lowest / 1.2, {kSurelyFree, kLast}, certainty)));
  EXPECT_TRUE(describes(estimates_of(1.01 * lowest / 1.2, {kSurelyFree, kLast}, certainty)));
  EXPECT_TRUE(describes(estimates_of(0.99 * highest * 1.2, {kSurelyCaptured, kLast}, certainty)));
  EXPECT_FALSE(describes(estimates_of(1.01 * highest * 1.2, {kSurelyCaptured, kLast}, certainty)));
}

// Twenty times as likely is decided; ln 20 = 3.0.
TEST(ModelDescribes, EndThatIsNotDecidedContradictsNothing) {
  EXPECT_TRUE(describes(estimates_of(0.5, {{SlipEnd::kFree, -2.9}, kLast})));
  EXPECT_FALSE(describes(estimates_of(0.5, {{SlipEnd::kFree, -3.1}, kLast})));
  EXPECT_TRUE(describes(estimates_of(2.0, {{SlipEnd::kCaptured, 2.9}, kLast})));
  EXPECT_FALSE(describes(estimates_of(2.0, {{SlipEnd::kCaptured, 3.1}, kLast})));
}

// An oscillation that goes on over three slips is one that is decided, whatever each of them tells.
TEST(ModelDescribes, OscillationOverThreeSlipsIsFree) {
  constexpr Slip kHardlyFree{SlipEnd::kFree, -1.0};
  EXPECT_TRUE(describes(estimates_of(0.5, {kHardlyFree, kLast})));
  EXPECT_FALSE(describes(estimates_of(0.5, {kHardlyFree, kHardlyFree, kLast})));
}

// A later swing of a free oscillation is smaller than S − K: its own Q is higher, and not asked.
TEST(ModelDescribes, OnlySlipsThatBeginFromStickAreAsked) {
  EXPECT_TRUE(describes(estimates_of(1.5, {kSurelyFree, kSurelyCaptured, kLast})));
}

// An acceleration shifts the threshold.
TEST(ModelDescribes, EndsAreAskedOfAConstantBeltOnly) {
  SlipEstimates estimates = estimates_of(0.5, {kSurelyFree, kLast});
  ASSERT_FALSE(describes(estimates));
  const auto ramp = model::PullSpeed::make({{0.0, 0.001}, {10.0, 0.01}});
  ASSERT_TRUE(ramp);
  estimates.belt = model::BeltMotion{*ramp, 0.0};
  EXPECT_TRUE(describes(estimates));
}

TEST(ModelDescribes, ResidualsOfFiveTimesTheNoiseAreAllowed) {
  SlipEstimates estimates = estimates_of(0.5, {kSurelyCaptured, kLast});
  estimates.fit.residual_sigma = 4.99 * kScanSigma;
  EXPECT_TRUE(describes(estimates));
  estimates.fit.residual_sigma = 5.01 * kScanSigma;
  EXPECT_FALSE(describes(estimates));
}

// By chance γ may be found up to four standard errors below zero; and two below 2 ω, where no oscillation is
// left, are needed.
TEST(ModelDescribes, DampingIsNeitherNegativeNorOverdamped) {
  constexpr double kError_per_s = 0.5;
  const auto with_gamma = [](double gamma_per_s) {
    SlipEstimates estimates = estimates_of(0.5, {{SlipEnd::kCaptured, 0.0}, kLast});
    estimates.fit.shared.gamma = gamma_per_s;
    estimates.fit.shared_covariance(1, 1) = kError_per_s * kError_per_s;
    return estimates;
  };
  EXPECT_TRUE(describes(with_gamma(-3.9 * kError_per_s)));
  EXPECT_FALSE(describes(with_gamma(-4.1 * kError_per_s)));
  EXPECT_TRUE(describes(with_gamma(2.0 * kOmega - 2.1 * kError_per_s)));
  EXPECT_FALSE(describes(with_gamma(2.0 * kOmega - 1.9 * kError_per_s)));
}

// Means leave out the first of three slips and more, and a slip whose S − K is less certain than the typical
// S − K is large.
TEST(ModelResults, SlipsThatTellNothingDoNotCountInTheMeans) {
  const auto kinetic = [](double relative_error, bool first_counts) {
    SlipEstimates estimates =
        estimates_of(0.5, {kSurelyCaptured, kSurelyCaptured, kSurelyCaptured, kSurelyCaptured, kLast});
    const std::vector<double> levels{0.9, 0.3, 0.3, 0.3, 0.7};
    for (std::size_t i = 0; i < levels.size(); ++i) {
      estimates.windows[i].slip.S = levels[i] + kS_minus_K;
      estimates.windows[i].slip.K = levels[i];
    }
    estimates.windows.back().inverse_curvature(1, 1) = std::pow(relative_error * kS_minus_K, 2);
    estimates.first_counts = first_counts;
    TestResults results;
    model_results({}, estimates, Misfit{}, {}, kScanSigma, results);
    return results.mu_k.value.value_or(std::nan(""));
  };
  EXPECT_NEAR(kinetic(0.99, false), 0.4, 1e-12);
  EXPECT_NEAR(kinetic(1.01, false), 0.3, 1e-12);
  EXPECT_NEAR(kinetic(0.99, true), 0.5, 1e-12);
}

TEST(ModelResults, EscapeSpeedsSayWhyTheScatterIsUnknown) {
  const auto reason = [](std::size_t slips, double S) {
    SlipEstimates estimates = estimates_of(0.5, std::vector<Slip>(slips, kSurelyCaptured));
    estimates.belt = model::BeltMotion{model::PullSpeed::make({{0.0, 0.001}, {9.0, 0.002}}).value(), 0.0};
    for (estimate::SlipWindow& window : estimates.windows) window.slip.S = S;
    TestResults results;
    escape_results(estimates, results);
    return results.escape_speed.reason;
  };
  EXPECT_EQ(reason(2, 0.35), "fewer than three slips to compare");
  EXPECT_EQ(reason(3, 0.25), "the mean S - K is not positive");
}

// A ring-down has the amplitude √((S − K)² + (u/ω)²) by the speed u of its onset: at 95 % of the belt's speed
// S − K is larger than at the whole. A slip that sticks again tells S − K by its times.
TEST(ModelResults, CreepBeforeASlipIsInTheSystematicPartOfRingDownsAlone) {
  const auto systematic = [](double part, const std::vector<Slip>& slips) {
    TestResults results;
    const SlipEstimates estimates = estimates_of(part, slips);
    model_results({}, estimates, Misfit{}, {}, kScanSigma, results);
    const double damper = estimates.fit.shared.gamma * estimates.fit.shared.r /
                          estimates.fit.shared.oscillator().omega0_squared();
    EXPECT_FALSE(results.mu_k.systematic_uncertainty);
    EXPECT_EQ(results.mu_s.systematic_uncertainty, results.delta_mu.systematic_uncertainty);
    const SystematicParts& parts = results.delta_mu.systematic_parts;
    EXPECT_NEAR(parts[UncertaintySource::kDamping].value_or(0.0), damper, 1e-15);
    EXPECT_NEAR(parts[UncertaintySource::kCreep].value_or(0.0),
                results.delta_mu.systematic_uncertainty.value_or(0.0) - damper, 1e-15);
    return results.delta_mu.systematic_uncertainty.value_or(0.0) - damper;
  };
  const double speed = 2.0 * model::Q_threshold(kGammaOver2Omega) * kS_minus_K;
  const double whole = std::hypot(kS_minus_K, speed);
  const double onset = 0.95 * speed;
  EXPECT_NEAR(systematic(2.0, {kSurelyFree, kLast}), std::sqrt(whole * whole - onset * onset) - kS_minus_K,
              1e-12);
  EXPECT_NEAR(systematic(0.5, {kSurelyCaptured, kLast}), 0.0, 1e-12);
}

/// Misfit of 200 slips of 40 scans, with noise of `noise` times that of a scan and `law`, in σ, over the
/// periods since the onset.
template <typename Law>
Misfit misfit_of(double noise, const Law& law) {
  constexpr int kSlips = 200;
  constexpr int kScans = 40;
  constexpr double kPeriods = 2.0;
  SlipEstimates estimates = estimates_of(0.5, std::vector<Slip>(kSlips, kSurelyCaptured));
  estimate::Trace trace;
  std::mt19937_64 random{20261128};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase;
  const double period_s = 2.0 * std::numbers::pi / kOmega;
  for (estimate::SlipWindow& window : estimates.windows) {
    window.captured = true;
    window.first = trace.size();
    const model::SlipModel model{estimates.fit.shared, window.slip, true, estimates.belt};
    model::TurnedBasis basis{estimates.fit.shared.oscillator()};
    const double first = phase(random);
    for (int scan = 0; scan < kScans; ++scan) {
      const double periods = kPeriods * ((first + scan) / kScans - 0.25);
      const double time_s = window.slip.onset_s + periods * period_s;
      trace.time_s.push_back(time_s);
      trace.value.push_back(model.place(time_s, basis).value +
                            kScanSigma * (law(periods) + noise * normal(random)));
      trace.usable.push_back(1);
    }
    window.end = trace.size();
  }
  estimates.fit.residual_sigma = noise * kScanSigma * estimate::kHuberResidualOfNoise;
  estimates.fit.freedom = static_cast<double>(trace.size());
  Misfit misfit;
  misfit.add(trace, estimates, kScanSigma);
  return misfit;
}

// Errors hold the size of the residuals already: noise of one and a half times σ makes Birge's ratio 1.5, and
// adds nothing. 64 bins and more tell the ratio to 9 %.
TEST(Misfit, OnlyWhatRepeatsIsAddedToErrors) {
  const Misfit noisy = misfit_of(1.5, [](double) { return 0.0; });
  EXPECT_GT(noisy.mean().birge_ratio(), 1.2);
  EXPECT_LT(noisy.beyond_noise(), std::sqrt(std::pow(1.0 + 3.0 * 0.09, 2) - 1.0));
  EXPECT_EQ(misfit_of(1.0, [](double) { return 0.0; }).beyond_noise(), 0.0);
  // Half a σ over half a period: the mean of some 100 scans is known to a tenth of σ.
  const Misfit bent =
      misfit_of(1.0, [](double periods) { return periods > 0.0 && periods < 0.5 ? 0.5 : 0.0; });
  EXPECT_GT(bent.beyond_noise(), 1.0);
}

}  // namespace
}  // namespace stickslip::analysis
