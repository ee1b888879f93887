// The live detector and its three estimators against simulated truth. The streams are seeded; a failure
// prints the scene.

#include "core/detect/live_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/detect/ring_down_watch.hpp"
#include "core/estimate/cycle_fit.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/live_trials.hpp"
#include "tests/support/sample_limits.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip::detect {
namespace {

using test::LiveOutcome;
using test::LiveScene;
using test::LiveTrial;

LiveSettings settings_of(const LiveScene& scene, EstimatorTier tier, bool characterised) {
  LiveSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.estimator = tier;
  if (characterised) settings.prior = scene.characterised();
  return settings;
}

/// Repeats for the sake of statistics.
int fewer(int trials) { return test::kSanitized ? std::max(trials / 10, 1) : trials; }

/// Errors of S − K over its truth, without the first slip.
struct Errors {
  double mean = 0.0;
  double deviation = 0.0;
  double pull = 0.0;  ///< rms error over standard error
  double count = 0.0;
  int without = 0;
};

Errors errors_of(LiveScene scene, EstimatorTier tier, bool characterised, int trials) {
  Errors errors;
  double squares = 0.0;
  double pulls = 0.0;
  for (int i = 0; i < trials; ++i, ++scene.seed) {
    const LiveTrial trial{scene};
    for (const LiveCycle& cycle : run_live(scene, settings_of(scene, tier, characterised)).cycles) {
      const auto number = static_cast<std::size_t>(cycle.cycle.number);
      if (number == 0 || number >= trial.slips().size()) continue;
      if (std::isnan(cycle.cycle.delta_mu)) {
        ++errors.without;
        continue;
      }
      const double truth = trial.slips()[number].S - trial.slips()[number].K;
      const double error = (cycle.cycle.delta_mu - truth) / truth;
      errors.count += 1.0;
      errors.mean += error;
      squares += error * error;
      pulls += std::pow(error * truth / cycle.cycle.delta_mu_standard_error, 2);
    }
  }
  errors.mean /= errors.count;
  errors.deviation = std::sqrt(squares / errors.count - errors.mean * errors.mean);
  errors.pull = std::sqrt(pulls / errors.count);
  return errors;
}

// What the fit says it is uncertain by is what it is wrong by; its bias is below that of a cycle.
TEST(LiveDetector, FitOfACycleIsAsGoodAsItSaysAtAnyScanRate) {
  struct Case {
    double scan_rate_Hz;
    double frequency_Hz;
    int trials;
  };
  for (const Case& at : {Case{50.0, 3.0, 20}, Case{350.0, 20.0, 20}, Case{1000.0, 20.0, 10},
                         Case{10'000.0, 20.0, 4}, Case{100'000.0, 20.0, 1}}) {
    LiveScene scene;
    scene.scan_rate_Hz = at.scan_rate_Hz;
    scene.frequency_Hz = at.frequency_Hz;
    const Errors errors = errors_of(scene, EstimatorTier::kFit, true, fewer(at.trials));
    SCOPED_TRACE(at.scan_rate_Hz);
    EXPECT_LE(errors.without, 0.01 * errors.count + 1.0);
    // The mean of errors, of which neighbours share ω, γ and r, and the bias.
    EXPECT_LE(std::abs(errors.mean), test::farthest_mean(errors.count) * errors.deviation + 0.002);
    // The Huber part that noise spares makes the pull a little small.
    EXPECT_LE(errors.pull, std::sqrt(test::highest_mean_square(errors.count)));
    constexpr double kOverstated = 1.25;  // Of ω, γ and r the last 32 cycles count, as if they might change.
    EXPECT_GE(errors.pull, std::sqrt(test::lowest_mean_square(errors.count)) / kOverstated);
  }
}

// All scans tell more than two turning points do.
TEST(LiveDetector, TheFitIsSurerThanTurningPoints) {
  const LiveScene scene;
  const int trials = fewer(20);
  const Errors points = errors_of(scene, EstimatorTier::kTurningPoints, true, trials);
  const Errors fit = errors_of(scene, EstimatorTier::kFit, true, trials);
  EXPECT_LT(std::abs(points.mean), 0.02);
  EXPECT_LE(std::abs(fit.mean), test::farthest_mean(fit.count) * fit.deviation + 0.002);
  EXPECT_LT(fit.deviation, 0.7 * points.deviation);
}

TEST(LiveDetector, DeclaresAnEscapeSoonAndNoneThatIsNot) {
  LiveScene scene;
  scene.slips = 5;
  scene.escape_Q = 2.618;  // S − K half of what it was: 35 % above the threshold.
  const int trials = fewer(200);
  int soon = 0;
  int at_all = 0;
  for (int i = 0; i < trials; ++i, ++scene.seed) {
    const LiveOutcome outcome = run_live(scene, settings_of(scene, EstimatorTier::kFit, true));
    EXPECT_EQ(outcome.false_escapes, 0) << "seed " << scene.seed;
    const double onset_s = LiveTrial{scene}.slips().back().onset_s;
    const double periods = (outcome.escape_declared_s - onset_s) * scene.frequency_Hz;
    soon += periods <= 1.5 ? 1 : 0;
    at_all += periods <= 3.0 ? 1 : 0;
  }
  EXPECT_GE(soon, 0.98 * trials);
  EXPECT_EQ(at_all, trials);
}

// Amplitude under three standard errors of one period's fit: √(2/17.5) σ each, so 1.01 σ; the oscillation of
// 0.079 at first has it after ln(0.079/0.00101)/(2π · 0.022) = 31.5 periods; noise moves that by one or two,
// and the end of a period is waited for.
TEST(LiveDetector, RingDownEndsInSteadySliding) {
  LiveScene scene;
  scene.slips = 0;
  scene.escape_Q = 3.0;
  scene.S = 0.35;
  scene.escape_periods = 60.0;
  for (scene.seed = 1; scene.seed <= 10; ++scene.seed) {
    const LiveTrial trial{scene};
    const LiveOutcome outcome = run_live(scene, settings_of(scene, EstimatorTier::kFit, true));
    const double periods = (outcome.sliding_declared_s - trial.slips()[0].onset_s) * scene.frequency_Hz;
    EXPECT_GE(periods, 22.0) << scene.seed;
    EXPECT_LE(periods, 40.0) << scene.seed;
  }
}

TEST(LiveDetector, WalksThroughThePhasesInTheirOrder) {
  const LiveScene scene;
  LiveTrial trial{scene};
  LiveDetector detector{settings_of(scene, EstimatorTier::kFit, false)};
  EXPECT_EQ(detector.state().phase, Phase::kIdle);
  Phase before = Phase::kIdle;
  double loading_s = 0.0;
  double first_slip_s = 0.0;
  double cycles_s = 0.0;
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
    detector.add(trial.next(), false);
    const Phase phase = detector.state().phase;
    if (phase == before) continue;
    EXPECT_EQ(static_cast<int>(phase), static_cast<int>(before) + 1);
    before = phase;
    (phase == Phase::kLoading     ? loading_s
     : phase == Phase::kFirstSlip ? first_slip_s
                                  : cycles_s) = trial.time_s(scan);
  }
  EXPECT_EQ(before, Phase::kCycles);
  const double onset_s = trial.slips()[0].onset_s;
  const double period_s = 1.0 / scene.frequency_Hz;
  EXPECT_GT(loading_s, onset_s - 0.35 / scene.shared().r);
  EXPECT_LT(loading_s, onset_s);
  EXPECT_GT(first_slip_s, onset_s);
  EXPECT_LT(first_slip_s, onset_s + period_s);
  EXPECT_LT(cycles_s, onset_s + 2.0 * period_s);
  static_cast<void>(detector.end());
  EXPECT_EQ(detector.state().phase, Phase::kEnd);
}

TEST(LiveDetector, FollowsABeltThatChangesItsSpeed) {
  LiveScene slow;
  slow.Q = 0.65;
  slow.slips = 8;
  LiveTrial before{slow};
  LiveDetector detector{settings_of(slow, EstimatorTier::kFit, true)};
  std::int64_t scan = 0;
  std::vector<LiveCycle> cycles;
  for (; scan < before.scan_count(); ++scan) {
    if (const auto cycle = detector.add(before.next(), false)) cycles.push_back(*cycle);
  }
  LiveScene fast = slow;
  fast.Q = 1.3;
  fast.slips = 8;
  LiveTrial after{fast};
  // The second belt takes over where the first left the force, in a stick.
  double value = 0.0;
  while (value < 0.27) value = after.next();
  for (std::int64_t k = 0; k < 200; ++k) {
    if (const auto cycle = detector.add(after.next(), false)) cycles.push_back(*cycle);
  }
  ASSERT_GE(cycles.size(), 12U);
  for (std::size_t i = cycles.size() - 3; i < cycles.size(); ++i) {
    EXPECT_NEAR(cycles[i].cycle.delta_mu, 0.05, 0.05 * 0.1) << i;
    // [18] falls as the belt gets faster: 2.1 at Q = 0.65, 1.21 at 1.3.
    EXPECT_NEAR(cycles[i].cycle.slip_speed_ratio, 1.21, 0.1) << i;
  }
}

TEST(LiveDetector, NeverAllocates) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    for (const bool characterised : {false, true}) {
      LiveScene scene;
      scene.escape_Q = 3.0;
      LiveTrial trial{scene};
      std::vector<double> scans;
      while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) scans.push_back(trial.next());
      scans[scans.size() / 2] += 0.5;  // a spike
      LiveDetector detector{settings_of(scene, tier, characterised)};
      const std::uint64_t before = test::allocation_count();
      int cycles = 0;
      for (const double scan : scans) cycles += detector.add(scan, false) ? 1 : 0;
      detector.gap(10);
      for (const double scan : scans) cycles += detector.add(scan, false) ? 1 : 0;
      cycles += detector.end() ? 1 : 0;
      EXPECT_EQ(test::allocation_count(), before) << name(tier);
      EXPECT_GT(cycles, 20) << name(tier);
    }
  }
}

/// Scans of a trial less some, which the detector is told of. \param gaps  first scan and count of each, in
/// their order. \return every cycle.
std::vector<LiveCycle> with_gaps(const LiveScene& scene, LiveDetector& detector,
                                 const std::vector<std::pair<std::int64_t, std::int64_t>>& gaps) {
  LiveTrial trial{scene};
  std::vector<LiveCycle> cycles;
  auto gap = gaps.begin();
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
    const double value = trial.next();
    for (; gap != gaps.end() && scan == gap->first + gap->second; ++gap) detector.gap(gap->second);
    if (gap != gaps.end() && scan >= gap->first) continue;
    if (const auto cycle = detector.add(value, false)) cycles.push_back(*cycle);
  }
  if (const auto last = detector.end()) cycles.push_back(*last);
  return cycles;
}

// However few scans lie between two gaps, times behind them are right, the slips there are told, and no
// estimator takes a torn slip for an escape.
TEST(LiveDetector, GapsInARowCostTheCyclesTheyLieInAlone) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    for (const bool characterised : {false, true}) {
      for (const std::int64_t between : {0, 1, 2, 3, 4, 5, 9}) {
        for (const double after_onset_s : {0.0, 0.01, 0.02, 0.03, 0.04, 0.05}) {
          LiveScene scene;
          scene.slips = 14;
          const LiveTrial trial{scene};
          constexpr std::size_t kTorn = 5;
          const auto first =
              static_cast<std::int64_t>((trial.slips()[kTorn].onset_s + after_onset_s) * scene.scan_rate_Hz);
          constexpr std::int64_t kLost = 9;
          const std::int64_t second = first + kLost + between;
          LiveDetector detector{settings_of(scene, tier, characterised)};
          const auto cycles = with_gaps(scene, detector, {{first, kLost}, {second, kLost}});
          const double begin_s = static_cast<double>(first) / scene.scan_rate_Hz;
          const double end_s = static_cast<double>(second + kLost) / scene.scan_rate_Hz;
          const double cycle_s = trial.slips()[2].onset_s - trial.slips()[1].onset_s;
          int untouched = 0;
          for (const LiveCycle& cycle : cycles) {
            const double peak_s = cycle.cycle.peak_time_s;
            // How a slip ends is told a fifth of a cycle into the next at the latest.
            if (!(peak_s < begin_s - 1.2 * cycle_s || peak_s > end_s + cycle_s)) continue;
            // Each peak is that of a slip of the trial, seven thousandths of a second behind its onset.
            const auto of = std::ranges::min_element(trial.slips(), {}, [&](const LiveTrial::TrueSlip& slip) {
              return std::abs(slip.onset_s + 0.007 - peak_s);
            });
            EXPECT_NEAR(peak_s - of->onset_s, 0.007, 0.003)
                << name(tier) << ", " << between << ", " << after_onset_s << ": " << peak_s;
            if (cycle.cycle.number + 2 >= detector.state().slip_count) continue;  // Its end is not seen.
            EXPECT_NE(cycle.cycle.flags & kCycleCaptured, 0)
                << name(tier) << ", " << between << ", " << after_onset_s << ": " << peak_s;
            ++untouched;
          }
          EXPECT_GE(untouched, 5) << name(tier) << ", " << between << ", " << after_onset_s;
          EXPECT_EQ(detector.state().regime, model::Regime::kStickSlip)
              << name(tier) << ", " << between << ", " << after_onset_s;
        }
      }
    }
  }
}

// Before anything slips, and before the last scan: nothing to tell of, and nothing is told.
TEST(LiveDetector, GapsWhereNothingIsUnderWay) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    const LiveScene scene;
    const std::int64_t count = LiveTrial{scene}.scan_count();
    LiveDetector whole{settings_of(scene, tier, false)};
    LiveDetector early{settings_of(scene, tier, false)};
    LiveDetector late{settings_of(scene, tier, false)};
    const auto cycles = with_gaps(scene, whole, {});
    EXPECT_EQ(with_gaps(scene, early, {{1, 3}, {20, 9}}).size(), cycles.size()) << name(tier);
    EXPECT_EQ(with_gaps(scene, late, {{count - 4, 3}}).size(), cycles.size()) << name(tier);
    EXPECT_EQ(late.state().regime, whole.state().regime) << name(tier);
    LiveDetector none{settings_of(scene, tier, false)};
    none.gap(5);
    none.gap(5);
    EXPECT_FALSE(none.end());
  }
}

// A free oscillation is followed on behind a gap: it does not end where its phase jumps.
TEST(LiveDetector, AGapInARingDownDoesNotEndIt) {
  for (const std::int64_t lost : {5, 9, 14, 26}) {
    for (std::int64_t first = 0; first < 18; ++first) {
      LiveScene scene;
      scene.slips = 3;
      scene.escape_Q = 3.0;
      scene.escape_periods = 8.0;  // e^{−8π·0.044} of it, a third, is left: far from its end.
      const LiveTrial trial{scene};
      const auto escaped =
          static_cast<std::int64_t>((trial.slips().back().onset_s + 0.1) * scene.scan_rate_Hz);
      LiveDetector detector{settings_of(scene, EstimatorTier::kFit, true)};
      (void)with_gaps(scene, detector, {{escaped + first, lost}});
      EXPECT_EQ(detector.state().regime, model::Regime::kRingDown) << lost << ", " << first;
    }
  }
}

TEST(LiveDetector, FlagsSpikesGapsAndSaturationOfTheirOwnCycleAlone) {
  const LiveScene scene;
  LiveTrial trial{scene};
  std::vector<double> scans;
  while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) scans.push_back(trial.next());
  const auto scan_of = [&](std::size_t slip, double after_s) {
    return static_cast<std::size_t>((trial.slips()[slip].onset_s + after_s) * scene.scan_rate_Hz);
  };
  const std::size_t spike = scan_of(3, 0.02);
  const std::size_t rail = scan_of(6, 0.02);
  LiveDetector detector{settings_of(scene, EstimatorTier::kFit, true)};
  std::vector<LiveCycle> cycles;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (const auto cycle = detector.add(scans[k] + (k == spike ? 0.3 : 0.0), k == rail))
      cycles.push_back(*cycle);
  }
  ASSERT_GE(cycles.size(), 9U);
  for (const LiveCycle& cycle : cycles) {
    EXPECT_EQ((cycle.cycle.flags & kCycleHasSpike) != 0, cycle.cycle.number == 3) << cycle.cycle.number;
    EXPECT_EQ((cycle.cycle.flags & kCycleIsSaturated) != 0, cycle.cycle.number == 6) << cycle.cycle.number;
    EXPECT_EQ(cycle.cycle.flags & kCycleHasGap, 0);
    EXPECT_EQ((cycle.cycle.flags & kCycleIsFirst) != 0, cycle.cycle.number == 0);
  }
}

// The despiker holds three scans back: a gap right behind a peak is known before the peak is followed.
TEST(LiveDetector, AGapOnEitherSideOfAPeakIsOfTheCycleItLiesIn) {
  const LiveScene scene;
  LiveTrial trial{scene};
  std::vector<double> scans;
  while (static_cast<std::int64_t>(scans.size()) < trial.scan_count()) scans.push_back(trial.next());
  constexpr std::size_t kSlip = 4;
  const auto onset = static_cast<std::ptrdiff_t>(trial.slips()[kSlip].onset_s * scene.scan_rate_Hz);
  const auto peak = std::max_element(scans.begin() + onset, scans.begin() + onset + 8) -
                    scans.begin();  // Within 7 ms of it.
  for (const std::ptrdiff_t first : {-4, -3, -2, -1, 1, 2, 3, 4}) {
    LiveDetector detector{settings_of(scene, EstimatorTier::kFit, true)};
    for (const LiveCycle& cycle : with_gaps(scene, detector, {{peak + first, 1}})) {
      const bool is_inside = cycle.cycle.number == static_cast<std::int64_t>(first < 0 ? kSlip - 1 : kSlip);
      EXPECT_EQ((cycle.cycle.flags & kCycleHasGap) != 0, is_inside) << first << ", " << cycle.cycle.number;
    }
  }
}

}  // namespace
}  // namespace stickslip::detect
