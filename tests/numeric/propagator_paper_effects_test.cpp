// Paper whose S and K differ from contact to contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using friction::Mode;
using sim::Coefficients;

sim::Motion scattered(double Q, double delta_mu_cv, double mu_k_sd, double length_m) {
  sim::Motion motion = motion_at(Q, 0.022);
  motion.paper.scatter = sim::Scatter{delta_mu_cv, mu_k_sd, length_m};
  return motion;
}

TEST(Scatter, HasTheMeansAndSpreadsThatAreAskedFor) {
  sim::Paper paper{{sim::Scatter{0.6, 0.02, 1.0}, {}}, {0.35, 0.30}};
  paper.restart(1);
  constexpr int kCount = 40'000;
  double delta = 0.0, delta_squares = 0.0, mu_k = 0.0, mu_k_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    paper.renew();
    const Coefficients now = paper.now();
    ASSERT_GE(now.mu_s, now.mu_k);
    delta += (now.mu_s - now.mu_k) / 0.05;
    delta_squares += std::pow((now.mu_s - now.mu_k) / 0.05, 2);
    mu_k += now.mu_k - 0.30;
    mu_k_squares += std::pow(now.mu_k - 0.30, 2);
  }
  const double mean = delta / kCount;
  EXPECT_NEAR(mean, 1.0, 5.0 * 0.6 / std::sqrt(kCount));
  // The variance of s² is (μ₄ − σ⁴)/n. For the log-normal, with w = 1 + cv², the kurtosis is
  // w⁴ + 2w³ + 3w² − 3 = 10.3, so that s is off by √(9.3/n)/2 = 0.8 % of itself; five times that.
  EXPECT_NEAR(std::sqrt(delta_squares / kCount - mean * mean) / 0.6, 1.0, 0.04);
  EXPECT_NEAR(mu_k / kCount, 0.0, 5.0 * 0.02 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(mu_k_squares / kCount) / 0.02, 1.0, 5.0 / std::sqrt(2.0 * kCount));
}

TEST(Scatter, NeverLeavesSBelowKNorKBelowZero) {
  for (const Coefficients mean : {Coefficients{0.35, 0.30}, {0.30, 0.30}, {0.01, 0.0}, {0.0, 0.0}}) {
    sim::Paper paper{{sim::Scatter{0.6, 0.5, 1.0}, {}}, mean};
    paper.restart(2);
    for (int i = 0; i < 10'000; ++i) {
      paper.renew();
      ASSERT_GE(paper.now().mu_k, 0.0);
      ASSERT_GE(paper.now().mu_s, paper.now().mu_k);
    }
  }
}

// The force at each onset is the S that the observer is told of; between two onsets neither changes.
TEST(Scatter, EachContactGivesWayAtItsOwnS) {
  const double rate_Hz = 1e6;
  const sim::Motion motion = scattered(0.5, 0.4, 0.005, 1.0);
  MotionRecorder recorder{rate_Hz};
  sim::Propagator sled{motion, rate_Hz, &recorder, 3};
  std::vector<double> coefficient(1'000'000);
  sled.next(coefficient);
  const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
  int onsets = 0;
  for (std::size_t i = 1; i < recorder.starts.size(); ++i) {
    const sim::ModeStart& start = recorder.starts[i];
    if (!start.onset) continue;
    const bool stuck_before = recorder.starts[i - 1].mode == Mode::kStick;
    ASSERT_TRUE(stuck_before || start.capture);  // A place too weak to hold gives way at once.
    if (!stuck_before || start.time.scan + 1 >= 1'000'000) continue;
    // From the scan before the onset, at the belt's rate.
    const double at_onset =
        coefficient[static_cast<std::size_t>(start.time.scan)] + r / rate_Hz * start.time.fraction;
    ASSERT_NEAR(at_onset, start.paper.mu_s, 1e-12);
    EXPECT_EQ(start.paper.mu_s, recorder.starts[i - 1].paper.mu_s);
    ++onsets;
  }
  EXPECT_GT(onsets, 5);
}

// Overdamped sliding settles at the belt's speed v: a new place every L/v.
TEST(Scatter, IsRenewedEveryCorrelationLengthOfSteadySliding) {
  sim::Motion motion = scattered(1.0, 0.3, 0.0, 1e-4);
  motion.oscillator = friction::Oscillator::from_omega0(kOmega * kOmega, 3.0 * kOmega);
  motion.belt[0].speed_m_per_s = 0.005;
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder, 4};
  std::vector<double> coefficient(3500);
  sled.next(coefficient);
  ASSERT_EQ(recorder.onsets_s.size(), 1U);
  const double since_s = 3499.0 / 350.0 - recorder.onsets_s.front();
  // Less than the belt's travel by what the coupling has stretched, which is back at its start here
  // but for S − K, as a length.
  const auto onset = std::find_if(recorder.starts.begin(), recorder.starts.end(),
                                  [](const sim::ModeStart& start) { return start.onset; });
  const double stretched_m = (onset->paper.mu_s - onset->paper.mu_k) * kGravity / (kOmega * kOmega);
  const double places = (0.005 * since_s + stretched_m) / 1e-4;
  std::vector<double> times_s;
  for (const sim::ModeStart& start : recorder.starts) {
    const double at_s = start.time.periods_since({}) / 350.0;
    if (at_s > recorder.onsets_s.front() && start.mode == Mode::kSlip) times_s.push_back(at_s);
  }
  EXPECT_NEAR(static_cast<double>(times_s.size()), places, 1.0);
  // K does not scatter here, so the force is at rest and places are met at even intervals.
  for (std::size_t i = times_s.size() - 100; i < times_s.size(); ++i) {
    EXPECT_NEAR(times_s[i] - times_s[i - 1], 1e-4 / 0.005, 1e-12);
  }
  EXPECT_NEAR(coefficient.back(), 0.30, 1e-12);
}

// Shorter than a slip is long, with slack in each cycle: hundreds of places a second.
TEST(Scatter, DoesNotDependOnTheScanRate) {
  sim::Motion motion = scattered(0.8, 0.5, 0.02, 5e-5);
  motion.mu_s = 0.8;
  motion.one_way_coupling = true;
  std::vector<double> coarse(2560);
  std::vector<double> fine(4 * coarse.size());
  sim::Propagator{motion, 256.0, nullptr, 5}.next(coarse);
  sim::Propagator{motion, 1024.0, nullptr, 5}.next(fine);
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    ASSERT_TRUE(std::isfinite(coarse[i]));
    // Each event adds some epsilons of time, and a slip forgets none of them: 1e4 of them at most.
    ASSERT_NEAR(coarse[i], fine[4 * i], 1e-9) << i;
  }
}

TEST(FirstPeak, RaisesOrLowersTheFirstSlipAlone) {
  for (const double change : {0.08, -0.03, -0.2}) {
    sim::Motion motion = motion_at(1.0, 0.022);
    motion.paper.first_peak = sim::FirstPeak{change, 0.0};
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder, 6};
    sled.skip(3500);
    int onsets = 0;
    for (const sim::ModeStart& start : recorder.starts) {
      if (!start.onset) continue;
      const double expected = ++onsets == 1 ? std::max(0.30, 0.35 + change) : 0.35;
      EXPECT_EQ(start.paper.mu_s, expected) << change << " onset " << onsets;
      EXPECT_EQ(start.paper.mu_k, 0.30);
    }
    // A first slip with S − K so small is above its threshold and never captured.
    EXPECT_EQ(onsets > 1, change > 0.0) << onsets;
  }
}

// A first peak high enough lets the sled slip so far that it is not captured, or so that it is
// although the rest of the paper would not capture it: at Q just above the threshold.
TEST(FirstPeak, CanDecideTheRegime) {
  sim::Motion motion = motion_at(2.0, 0.022);  // The threshold is 1.94.
  const auto captures_after_onset = [&] {
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder, 7};
    sled.skip(1750);
    return std::count_if(recorder.captures_s.begin(), recorder.captures_s.end(),
                         [&](double at_s) { return at_s > recorder.onsets_s.front(); });
  };
  EXPECT_EQ(captures_after_onset(), 0);
  motion.paper.first_peak = sim::FirstPeak{0.02, 0.0};
  EXPECT_EQ(captures_after_onset(), 1);
}

TEST(FirstPeak, IsRandomFromRunToRunAndRepeatsWithItsSeed) {
  sim::Paper paper{{{}, sim::FirstPeak{0.0, 0.01}}, {0.5, 0.3}};
  double squares = 0.0;
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    paper.restart(static_cast<std::uint64_t>(run));
    paper.renew();
    squares += std::pow(paper.now().mu_s - 0.5, 2);
    const double first = paper.now().mu_s;
    paper.restart(static_cast<std::uint64_t>(run));
    paper.renew();
    ASSERT_EQ(paper.now().mu_s, first);
  }
  EXPECT_NEAR(std::sqrt(squares / kRuns) / 0.01, 1.0, 5.0 / std::sqrt(2.0 * kRuns));
}

}  // namespace
}  // namespace stickslip::numeric
