// Where an event finder goes wrong: grazing, nothing to divide by, very long, very slow.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using model::Mode;

/// Captures after the first onset, in the first seconds; −1 if there was no onset.
int slips_captured(const sim::Motion& motion, double duration_s) {
  MotionRecorder recorder{kRate_Hz};
  sim::Propagator sled{motion, kRate_Hz, &recorder};
  sled.skip(static_cast<std::int64_t>(duration_s * kRate_Hz));
  if (recorder.onsets_s.empty()) return -1;
  const auto is_later = [&](double capture_s) { return capture_s > recorder.onsets_s.front(); };
  return static_cast<int>(std::count_if(recorder.captures_s.begin(), recorder.captures_s.end(), is_later));
}

TEST(PropagatorHardCases, EachSideOfTheThresholdHasItsRegimeToTenDigits) {
  for (const double damping : {0.001, 0.022, 0.3}) {
    const double Q_th = model::Q_threshold(damping);
    for (int n = 2; n <= 10; ++n) {
      const double step = std::pow(10.0, -n);
      // K = 2: a belt that starts at once takes the sled along only if its r < ω K or so.
      EXPECT_GE(slips_captured(motion_at(Q_th * (1.0 - step), damping, 2.05, 2.0), 10.0), 100) << n;
      EXPECT_EQ(slips_captured(motion_at(Q_th * (1.0 + step), damping, 2.05, 2.0), 10.0), 0) << n;
    }
  }
}

// t_e ≈ t₃ − 0.67 √(1 − Q/Q_th)/ω near the threshold.
TEST(PropagatorHardCases, CaptureJustBelowTheThresholdIsOnTime) {
  const double damping = 0.022;
  const double below = 1e-6;
  const double Q = model::Q_threshold(damping) * (1.0 - below);
  const sim::Motion motion = motion_at(Q, damping);
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(350);
  const model::SlipWaveform slip{0.30, 0.05, Q * kOmega * 0.05, motion.oscillator};
  const double expected_s = slip.rise_end_time_s() - 0.67 * std::sqrt(below) / kOmega;
  const double slip_s = recorder.captures_s.at(1) - recorder.onsets_s.at(0);
  EXPECT_NEAR(slip_s, expected_s, 0.01 * std::sqrt(below) / kOmega);  // 0.67 has two digits.
  EXPECT_NEAR(slip.rate(slip_s) / slip.r, 1.0, 1e-12);
}

// γ = 0 and S = K: each cycle touches the speed of the belt and does not stay.
TEST(PropagatorHardCases, UndampedWithoutDeltaMuGrazesOnceACycle) {
  sim::Motion motion = motion_at(1.0, 0.0);
  motion.mu_s = motion.mu_k;
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(350 * 100);
  // 20 Hz for 100 s less the first rise of the force; at most two changes of mode a cycle.
  EXPECT_NEAR(static_cast<double>(recorder.onsets_s.size()), 2000.0, 5.0);
  EXPECT_LE(recorder.starts.size(), 2U * 2000U + 10U);
}

TEST(PropagatorHardCases, TinyDeltaMuIsNoDivision) {
  for (const double delta_mu : {1e-3, 1e-9, 1e-15}) {
    for (const double damping : {0.0, 0.022}) {
      sim::Motion motion = motion_at(1.0, damping);
      motion.mu_s = motion.mu_k + delta_mu;
      const std::vector<double> coefficient = trace(motion, 350.0, 3500);
      const double r = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity);
      // [2]; damping only lowers it.
      const double most = motion.mu_k + std::hypot(delta_mu, r / kOmega) * (1.0 + damping) + 1e-12;
      for (const double c : coefficient) ASSERT_TRUE(c >= 0.0 && c <= most) << c;
    }
  }
}

// A million cycles: each starts from exactly (S, r), so the peak cannot creep, and the time is a sum
// of a million rounded durations with at most 2 ε each of their 17.5 scans.
TEST(PropagatorHardCases, MillionUndampedCycles) {
  const double Q = 1.3;
  const sim::Motion motion = motion_at(Q, 0.0);

  struct Ends final : sim::MotionObserver {
    void mode_began(const sim::ModeStart& start) override {
      if (!start.onset) return;
      if (count++ == 0) first = start.time;
      last = start.time;
    }
    std::int64_t count = 0;
    sim::ScanTime first, last;
  } ends;
  sim::Propagator sled{motion, kRate_Hz, &ends};
  const double period_s = (model::undamped_slip_phase_rad(Q) + model::undamped_stick_phase_rad(Q)) / kOmega;
  sled.skip(static_cast<std::int64_t>(1e6 * period_s * kRate_Hz));
  ASSERT_GT(ends.count, 999'000);
  const double elapsed_s = ends.last.periods_since(ends.first) / kRate_Hz;
  const double cycles = static_cast<double>(ends.count - 1);
  EXPECT_NEAR(elapsed_s / (cycles * period_s), 1.0, 40.0 * kEpsilon);

  // The state after a million cycles is the state after three, at the same phase.
  std::vector<double> late(2000);
  sled.next(late);
  const double peak = *std::max_element(late.begin(), late.end());
  const double true_peak = model::undamped_maximum(0.30, 0.05, Q);
  EXPECT_LE(peak, true_peak + 1e-12);
  // The nearest of 2000 scans in 110 cycles is within 1/220 of a scan or so of a peak.
  EXPECT_GT(peak, true_peak - 1e-4);
}

TEST(PropagatorHardCases, SlowestBeltSticksInOneEvent) {
  for (const double speed : {1e-12, 1e-9, 1e-6}) {
    sim::Motion motion = motion_at(1.0, 0.022);
    motion.belt = {{1e15, speed, false}};
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    const double r = motion.oscillator.stick_rate_per_s(speed, kGravity);
    sled.skip(static_cast<std::int64_t>(1.1 * 0.35 / r * 350.0));
    ASSERT_GE(recorder.onsets_s.size(), 1U) << speed;
    // Catching up with the belt takes r/(ω₀²K) and is not stepped over either.
    const double catch_up_s = r / (motion.oscillator.omega0_squared() * 0.30);
    EXPECT_NEAR(recorder.onsets_s[0], 0.35 / r, catch_up_s + 1e-12 / r) << speed;
    EXPECT_LE(recorder.starts.size(), 1000U) << speed;
  }
}

// 10⁷ s: the scan index carries the time, and the onsets stay where the period puts them.
TEST(PropagatorHardCases, TenMillionSecondsLoseNoPhase) {
  sim::Motion motion = motion_at(1.0, 0.022);
  motion.belt = {{1e12, 1e-8, false}};
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  sled.skip(3'500'000'000);
  ASSERT_GT(recorder.onsets_s.size(), 1000U);
  const double period_s = recorder.onsets_s[1] - recorder.onsets_s[0];
  const double expected_s =
      recorder.onsets_s[0] + static_cast<double>(recorder.onsets_s.size() - 1) * period_s;
  // period_s is a difference of two times of about 10⁴ s, good to 2e-12 and taken 1700 times; the
  // last time itself is only written to 2e-9.
  EXPECT_NEAR(recorder.onsets_s.back(), expected_s, 1e-8);
}

TEST(PropagatorHardCases, OverdampedNeverSticksAgain) {
  sim::Motion motion = motion_at(0.1, 0.022);
  const double omega0_squared = motion.oscillator.omega0_squared();
  for (const double ratio : {0.9, 0.999999, 1.0, 1.000001, 3.0}) {
    motion.oscillator =
        model::Oscillator::from_omega0(omega0_squared, 2.0 * std::sqrt(omega0_squared) * ratio);
    EXPECT_EQ(slips_captured(motion, 100.0), 0) << ratio;
    EXPECT_NEAR(trace(motion, 350.0, 35'000).back(), 0.30, 1e-12) << ratio;  // Steady sliding.
  }
}

// Without damping and S ≥ 2K the force must reach zero in each cycle.
TEST(PropagatorHardCases, OneWayCouplingGoesSlackAndComesBack) {
  sim::Motion motion = motion_at(0.5, 0.0, 0.70, 0.30);
  motion.one_way_coupling = true;
  MotionRecorder recorder{350.0};
  sim::Propagator sled{motion, 350.0, &recorder};
  std::vector<double> coefficient(3500);
  sled.next(coefficient);
  const auto slack = std::count_if(recorder.starts.begin(), recorder.starts.end(),
                                   [](const sim::ModeStart& start) { return start.mode == Mode::kSlack; });
  EXPECT_GE(slack, 50);
  EXPECT_GE(recorder.onsets_s.size(), 50U);  // And each time it sticks again.
  EXPECT_GE(*std::min_element(coefficient.begin(), coefficient.end()), 0.0);
  EXPECT_EQ(*std::min_element(coefficient.begin(), coefficient.end()), 0.0);
}

// At S a hair above and below the value where the undamped minimum K − D√(1 + Q²) is zero.
TEST(PropagatorHardCases, TouchingZeroFromAboveIsNotSlack) {
  for (const double excess : {-1e-9, 0.0, 1e-9}) {
    sim::Motion motion = motion_at(1.0, 0.0);
    motion.one_way_coupling = true;
    const double r = kOmega * 0.1;
    const double D = std::sqrt(0.09 - 0.01) + excess;  // √(D² + (r/ω)²) = K
    motion.mu_s = motion.mu_k + D;
    motion.belt = {{1e12, r * kGravity / motion.oscillator.omega0_squared(), false}};
    MotionRecorder recorder{350.0};
    sim::Propagator sled{motion, 350.0, &recorder};
    sled.skip(3500);
    const bool slack = std::any_of(recorder.starts.begin(), recorder.starts.end(),
                                   [](const sim::ModeStart& start) { return start.mode == Mode::kSlack; });
    if (excess != 0.0) {
      EXPECT_EQ(slack, excess > 0.0);
    }
    EXPECT_GE(recorder.onsets_s.size(), 100U);
    EXPECT_LE(recorder.starts.size(), 2000U);
  }
}

TEST(PropagatorHardCases, BeltBackwardsIsTheMirrorImage) {
  sim::Motion motion = motion_at(1.3, 0.022);
  const std::vector<double> forwards = trace(motion, 350.0, 3500);
  motion.belt[0].speed_m_per_s = -motion.belt[0].speed_m_per_s;
  const std::vector<double> backwards = trace(motion, 350.0, 3500);
  for (std::size_t i = 0; i < forwards.size(); ++i) ASSERT_EQ(forwards[i], -backwards[i]) << i;
}

TEST(PropagatorHardCases, BeltThatStopsLeavesTheForceAndReturnEndsIt) {
  for (const double mu_s : {0.325, 0.35, 0.75}) {
    sim::Motion motion = motion_at(1.0, 0.022, mu_s, 0.30);
    motion.one_way_coupling = true;
    const double speed = 0.00508;
    motion.belt = {{0.5, 0.0, false}, {5.0, speed, false}, {1.0, 0.0, false}, {0.5, -speed, true}};
    const std::vector<double> coefficient = trace(motion, 350.0, 350 * 8);
    EXPECT_EQ(coefficient[170], 0.0);
    const double held = coefficient[350 * 6];
    // At S = 0.75 the belt happens to stop while the coupling is slack.
    if (mu_s < 0.6) {
      EXPECT_GT(held, 0.0) << mu_s;
    }
    for (std::size_t i = 350 * 6; i < 350 * 65 / 10; ++i) ASSERT_EQ(coefficient[i], held);
    for (std::size_t i = 350 * 7; i < coefficient.size(); ++i) ASSERT_EQ(coefficient[i], 0.0);
  }
}

}  // namespace
}  // namespace stickslip::numeric
