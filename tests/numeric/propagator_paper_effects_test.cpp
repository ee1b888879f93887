// Paper whose S and K differ from contact to contact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/numeric/motion_recorder.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::numeric {
namespace {

using model::Mode;
using sim::Coefficients;

sim::Motion scattered(double Q, double delta_mu_cv, double mu_k_sd, double length_m) {
  sim::Motion motion = motion_at(Q, 0.022);
  motion.paper.scatter = sim::Scatter{delta_mu_cv, mu_k_sd, length_m};
  return motion;
}

// One sheet with many contacts: the moments of a random number generator, not repeated tests.
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
  motion.oscillator = model::Oscillator::from_omega0(kOmega * kOmega, 3.0 * kOmega);
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
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    paper.restart(static_cast<std::uint64_t>(run));
    paper.renew();
    squares += std::pow((paper.now().mu_s - 0.5) / 0.01, 2);
    const double first = paper.now().mu_s;
    paper.restart(static_cast<std::uint64_t>(run));
    paper.renew();
    ASSERT_EQ(paper.now().mu_s, first);
  }
  EXPECT_LT(squares / kRuns, test::highest_mean_square(kRuns));
  EXPECT_GT(squares / kRuns, test::lowest_mean_square(kRuns));
}

sim::Motion ageing(double Q, double per_decade, double cutoff_s) {
  sim::Motion motion = motion_at(Q, 0.022);
  motion.paper.contact_ageing = sim::ContactAgeing{per_decade, cutoff_s};
  return motion;
}

TEST(ContactAgeing, EachContactGivesWayAtTheSOfItsAge) {
  for (const double per_decade : {0.001, 0.01, 0.1}) {
    MotionRecorder recorder{350.0};
    sim::Propagator sled{ageing(0.5, per_decade, 1e-4), 350.0, &recorder};
    sled.skip(35'000);
    ASSERT_GT(recorder.onsets_s.size(), 10U);
    for (std::size_t i = 1; i < recorder.starts.size(); ++i) {
      const sim::ModeStart& onset = recorder.starts[i];
      if (!onset.onset) continue;
      const double rested_s = onset.time.periods_since(recorder.starts[i - 1].time) / 350.0;
      const double S = 0.35 + per_decade * std::log10(1.0 + rested_s / 1e-4);
      // Times carry an epsilon of their scan, 1e-19 s, the sums of S a few of its own.
      EXPECT_NEAR(onset.paper.mu_s, S, 1e-13);
      EXPECT_EQ(onset.coefficient, onset.paper.mu_s);
    }
  }
}

// The force that is there at the moment of giving way is S: nothing jumps.
TEST(ContactAgeing, ForceIsContinuousAtTheOnset) {
  const sim::Motion motion = ageing(0.5, 0.02, 1e-3);
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(3500);
  const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
  int checked = 0;
  for (std::size_t i = 1; i < recorder.starts.size(); ++i) {
    const sim::ModeStart& before = recorder.starts[i - 1];
    const sim::ModeStart& onset = recorder.starts[i];
    if (!onset.onset || before.mode != Mode::kStick) continue;
    const double c = before.coefficient + r * onset.time.periods_since(before.time) / 350.0;
    // The bracket closes to 2 epsilon of the time, 1e-2 s, at r = 3/s; the excess has 5 roundings.
    ASSERT_NEAR(c, onset.coefficient, 1e-14);
    ++checked;
  }
  EXPECT_GT(checked, 20);
}

TEST(ContactAgeing, NothingPerDecadeIsNothing) {
  EXPECT_EQ(trace(ageing(1.3, 0.0, 1e-3), 350.0, 3500), trace(motion_at(1.3, 0.022), 350.0, 3500));
}

// At first S may grow faster than the force, also where the force is already S: no rest, no ageing,
// but then it holds.
TEST(ContactAgeing, SThatRunsAheadIsCaughtLater) {
  const sim::ContactAgeing law{0.01, 1e-9};
  for (const double held : {0.35, 0.34, -0.35}) {
    for (const double rate : {1e-12, 1e-3, 1.0, 1e3}) {
      const double t_s = law.gives_way_s(held, rate, 0.35, 0.0);
      ASSERT_GT(t_s, 0.0);
      const double S = 0.35 + 0.01 * std::log10(1.0 + t_s / 1e-9);
      // To 2 epsilon of t, and ten of the terms, the force among them.
      EXPECT_NEAR((held + rate * t_s) / S, 1.0, 1e-14) << held << " " << rate;
    }
  }
}

// Ten times slower, a decade more of rest: S is higher by β. One event, however slow.
TEST(ContactAgeing, SlowBeltGainsBetaPerDecade) {
  const auto first_S = [](double speed_m_per_s) {
    sim::Motion motion = ageing(1.0, 0.01, 1e-6);
    motion.belt = {{1e15, speed_m_per_s, false}};
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    const double r = motion.oscillator.stick_rate_per_s(speed_m_per_s, kGravity);
    sled.skip(static_cast<std::int64_t>(0.8 / r * 350.0));  // S is 0.5 or so by then.
    const auto onset = std::find_if(recorder.starts.begin(), recorder.starts.end(),
                                    [](const sim::ModeStart& start) { return start.onset; });
    return onset == recorder.starts.end() ? 0.0 : onset->paper.mu_s;
  };
  // t = S/r: S itself grows by β/S = 2 % from decade to decade, which is log₁₀ 1.02 = 0.009 of one.
  EXPECT_NEAR(first_S(1e-12) - first_S(1e-11), 0.01, 0.0002);
}

TEST(OnsetConvention, WithTheDamperIsALowerSByItsShare) {
  for (const double damping : {0.0, 0.022, 0.3}) {
    for (const double direction : {1.0, -1.0}) {
      sim::Motion damper = motion_at(1.0, damping);
      damper.belt[0].speed_m_per_s *= direction;
      damper.damper_counts_at_onset = true;
      sim::Motion spring = motion_at(1.0, damping);
      spring.belt = damper.belt;
      // γ v/g, the share that the paper's convention leaves out.
      spring.mu_s -= damper.oscillator.gamma_per_s * std::abs(damper.belt[0].speed_m_per_s) / kGravity;
      if (spring.mu_s < spring.mu_k) continue;
      const std::vector<double> a = trace(damper, 350.0, 3500);
      const std::vector<double> b = trace(spring, 350.0, 3500);
      // S differs by an epsilon of 0.35, which each of 200 cycles may add to the time; c′ · t is 8 · that.
      for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-11) << damping << " scan " << i;
    }
  }
}

// A share of the damper above S − K: the spring alone is below K at the onset, and all is still well.
TEST(OnsetConvention, DamperMayHoldMoreThanSMinusK) {
  sim::Motion motion = motion_at(3.0, 0.3);
  motion.damper_counts_at_onset = true;
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  std::vector<double> coefficient(3500);
  sled.next(coefficient);
  ASSERT_EQ(recorder.onsets_s.size(), 1U);
  const auto onset = std::find_if(recorder.starts.begin(), recorder.starts.end(),
                                  [](const sim::ModeStart& start) { return start.onset; });
  EXPECT_LT(onset->coefficient, 0.30);
  EXPECT_EQ(onset->paper.mu_s, 0.35);
  EXPECT_NEAR(coefficient.back(), 0.30, 1e-12);
}

}  // namespace
}  // namespace stickslip::numeric
