// The simulated sled against what the paper prints.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using std::numbers::pi;

/// So fine that a maximum between two scans is missed by less than ω₀²A/8 · Δt² ≈ 2e-10.
constexpr double kFineRate_Hz = 1e6;

struct Row {
  double speed_in_per_min;
  double apparent_static;
  double frequency_Hz;
};

sim::Motion table1_motion(double speed_in_per_min) {
  sim::Motion motion = motion_at(1.0, 0.0);
  motion.gravity_m_per_s2 = 384.0 * 0.0254;  // 32 ft/s² = 384 in/s², the paper's own.
  motion.belt = {{1e12, speed_in_per_min * 0.0254 / 60.0, false}};
  return motion;
}

TEST(PropagatorPaper, Table1) {
  for (const Row& row :
       {Row{3, 0.35260922, 12.711701}, Row{6, 0.35975718, 17.082159}, Row{12, 0.38236311, 19.314034}}) {
    const sim::Motion motion = table1_motion(row.speed_in_per_min);
    MotionRecorder recorder{kFineRate_Hz};
    sim::Propagator sled{motion, kFineRate_Hz, &recorder};
    std::vector<double> coefficient(500'000);
    sled.next(coefficient);

    EXPECT_NEAR(*std::max_element(coefficient.begin(), coefficient.end()), row.apparent_static,
                0.5e-8 + 2e-10);
    ASSERT_GE(recorder.onsets_s.size(), 4U);
    const double frequency_Hz = static_cast<double>(recorder.onsets_s.size() - 1) /
                                (recorder.onsets_s.back() - recorder.onsets_s.front());
    EXPECT_NEAR(frequency_Hz, row.frequency_Hz, 0.5e-6);
  }
}

TEST(PropagatorPaper, UndampedTimesAndMean) {
  const double Q = 1.3;
  const sim::Motion motion = motion_at(Q, 0.0);
  MotionRecorder recorder{kFineRate_Hz};
  sim::Propagator sled{motion, kFineRate_Hz, &recorder};
  std::vector<double> coefficient(500'000);
  sled.next(coefficient);

  ASSERT_GE(recorder.onsets_s.size(), 3U);
  const double slip_s = recorder.captures_s[1] - recorder.onsets_s[0];
  const double stick_s = recorder.onsets_s[1] - recorder.captures_s[1];
  EXPECT_NEAR(kOmega * slip_s, model::undamped_slip_phase_rad(Q), 1e-13);    // [4]
  EXPECT_NEAR(kOmega * stick_s, model::undamped_stick_phase_rad(Q), 1e-13);  // [3]

  // [1] over whole cycles. The ends are off by at most one scan: 0.1/(Δonset · rate) ≈ 1e-6.
  const auto first = static_cast<std::ptrdiff_t>(recorder.onsets_s.front() * kFineRate_Hz);
  const auto end = static_cast<std::ptrdiff_t>(recorder.onsets_s.back() * kFineRate_Hz);
  const double sum = std::accumulate(coefficient.begin() + first, coefficient.begin() + end, 0.0);
  EXPECT_NEAR(sum / static_cast<double>(end - first), 0.30, 1e-6);
}

// Fig. 5: the levels of an oscillation at the threshold, here from just below.
TEST(PropagatorPaper, LevelsOfTheThresholdOscillation) {
  const double damping = model::gamma_over_2omega_of_half_life(5.0);
  const sim::Motion motion = motion_at(model::Q_threshold(damping) * (1.0 - 1e-12), damping);
  MotionRecorder recorder{kFineRate_Hz};
  sim::Propagator sled{motion, kFineRate_Hz, &recorder};
  std::vector<double> coefficient(300'000);
  sled.next(coefficient);

  ASSERT_GE(recorder.onsets_s.size(), 3U);
  const auto first = static_cast<std::ptrdiff_t>(recorder.onsets_s.front() * kFineRate_Hz);
  const auto end = static_cast<std::ptrdiff_t>(recorder.onsets_s.back() * kFineRate_Hz);
  const auto begin = coefficient.begin() + first;
  const auto stop = coefficient.begin() + end;
  const double half_digit = 0.5e-5;
  EXPECT_NEAR(*std::max_element(begin, stop), 0.40732, half_digit);
  EXPECT_NEAR(*std::min_element(begin, stop), 0.19987, half_digit);
  EXPECT_NEAR(std::accumulate(begin, stop, 0.0) / static_cast<double>(end - first), 0.30240, half_digit);
  // The scan after the capture lies r/rate ≈ 1e-5 above the level where sticking starts at most.
  const double captured_s = recorder.captures_s[1];
  const auto scan = static_cast<std::size_t>(std::ceil(captured_s * kFineRate_Hz));
  const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
  const double since_s = static_cast<double>(scan) / kFineRate_Hz - captured_s;
  EXPECT_NEAR(coefficient[scan] - r * since_s, 0.29573, half_digit);
}

TEST(PropagatorPaper, AmplitudeAndSlipSpeedOfEachCycleAreThoseOfTheClosedForms) {
  const double Q = 1.3;
  const double damping = 0.022;
  const sim::Motion motion = motion_at(Q, damping);
  const std::vector<double> coefficient = trace(motion, kFineRate_Hz, 400'000);
  const auto [least, most] = std::minmax_element(coefficient.begin() + 100'000, coefficient.end());
  EXPECT_NEAR((*most - *least) / 2.0 / 0.05, model::amplitude_ratio(Q, damping), 1e-8);  // [17]
  double fastest = 0.0;
  for (std::size_t i = 100'000; i < coefficient.size(); ++i) {
    fastest = std::min(fastest, (coefficient[i] - coefficient[i - 1]) * kFineRate_Hz);
  }
  const double r = Q * kOmega * 0.05;
  // Differences of 1e6 Hz scans carry 2·ε·0.3·1e6 ≈ 1e-10 and the curvature of c′.
  EXPECT_NEAR(-fastest / r, model::slip_speed_ratio(Q, damping), 1e-8);  // [18]
}

TEST(PropagatorPaper, RingDownHalvesInFiveCycles) {
  const double damping = model::gamma_over_2omega_of_half_life(5.0);
  const sim::Motion motion = motion_at(2.6, damping);
  const std::vector<double> coefficient = trace(motion, 1e5, 200'000);
  const auto range = [&](std::size_t first) {
    const auto begin = coefficient.begin() + static_cast<std::ptrdiff_t>(first);
    const auto [least, most] = std::minmax_element(begin, begin + 5'000);  // One period at 20 Hz.
    return *most - *least;
  };
  // A window that holds one maximum and one minimum; scans 1e-5 s apart miss 1e-6 of each.
  EXPECT_NEAR(range(60'000) / range(35'000), 0.5, 1e-5);
}

}  // namespace
}  // namespace stickslip::numeric
