// How far the force is from exact after n cycles: the same motion in 50 digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/accuracy/oscillation50.hpp"
#include "core/model/threshold.hpp"
#include "core/sim/propagator.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

using accuracy::Real;

/// Sticking and slipping for ever in 50 digits: one cycle, from the state (S, r) on.
class Cycle50 {
 public:
  Cycle50(const sim::Motion& motion, double captured_about_s)
      : S_(motion.mu_s),
        r_((Real(motion.oscillator.omega_squared) +
            Real(motion.oscillator.gamma_per_s) * motion.oscillator.gamma_per_s / 4) *
           motion.belt[0].speed_m_per_s / Real(motion.gravity_m_per_s2)),
        slip_{Real(motion.mu_k), Real(motion.mu_s) - Real(motion.mu_k), r_,
              Real(motion.oscillator.gamma_per_s), Real(motion.oscillator.omega_squared)},
        captured_s_(capture(slip_, captured_about_s)),
        captured_(slip_.value(captured_s_)),
        period_s_(captured_s_ + (S_ - captured_) / r_) {}

  /// c′ = r by Newton's method from a guess good to some digits.
  [[nodiscard]] Real capture(const accuracy::Oscillation50& slip, double about_s) const {
    Real t = about_s;
    const Real omega0_squared = slip.omega_squared + slip.gamma * slip.gamma / 4;
    for (int i = 0; i < 7; ++i) {
      const Real slope = -slip.gamma * slip.rate(t) - omega0_squared * (slip.value(t) - slip.K);
      t -= (slip.rate(t) - r_) / slope;
    }
    return t;
  }

  [[nodiscard]] Real value(const Real& since_onset_s) const {
    const Real t = since_onset_s - floor(Real(since_onset_s / period_s_)) * period_s_;
    return t < captured_s_ ? slip_.value(t) : Real(captured_ + r_ * (t - captured_s_));
  }
  /// A belt that starts at once first catches the sled up: from rest, unloaded.
  [[nodiscard]] Real first_onset_s(double captured_about_s) const {
    const accuracy::Oscillation50 start{slip_.K, -slip_.K, Real(0), slip_.gamma, slip_.omega_squared};
    const Real captured_s = capture(start, captured_about_s);
    return captured_s + (S_ - start.value(captured_s)) / r_;
  }
  [[nodiscard]] double period_s() const { return static_cast<double>(period_s_); }

 private:
  Real S_, r_;
  accuracy::Oscillation50 slip_;
  Real captured_s_, captured_, period_s_;
};

// The law of docs/accuracy.md: 4 ε n P max|c′| + 8 ε. Of each cycle's time no more than four epsilons of the
// period are wrong, which the force shows at its steepest; the rest is the value's own rounding.
TEST(PropagatorAccuracy, ErrorAfterNCyclesIsNTimesFourEpsilonsOfAPeriod) {
  for (const double Q : {0.3, 1.0, 1.3, 1.7}) {
    for (const double damping : {0.001, 0.022, 0.1}) {
      const sim::Motion motion = motion_at(Q, damping);
      if (Q > 0.9 * model::Q_threshold(damping)) continue;  // Away from grazing.
      MotionRecorder recorder{kRate_Hz};
      sim::Propagator sled{motion, kRate_Hz, &recorder};
      sled.skip(350);
      ASSERT_GE(recorder.captures_s.size(), 2U);
      const Cycle50 cycle{motion, recorder.captures_s[1] - recorder.onsets_s[0]};
      const Real first_s = cycle.first_onset_s(recorder.captures_s[0]);
      // max|c′| ≤ ω₀ √(D² + (r/ω₀)²).
      const double steepest = kOmega * std::hypot(0.05, Q * 0.05) * 1.1;
      std::vector<double> coefficient(200);
      for (const std::int64_t n : {3, 100, 10'000, 100'000}) {
        const auto scan = static_cast<std::int64_t>(static_cast<double>(n) * cycle.period_s() * kRate_Hz);
        sled.restart(1);
        sled.skip(scan);
        sled.next(coefficient);
        const double law =
            4.0 * kEpsilon * static_cast<double>(n + 12) * cycle.period_s() * steepest + 8.0 * kEpsilon;
        double worst = 0.0;
        for (std::size_t i = 0; i < coefficient.size(); ++i) {
          const Real since_s = Real(scan + static_cast<std::int64_t>(i)) / Real(kRate_Hz) - first_s;
          if (since_s < 0) continue;
          worst = std::max(worst, std::abs(static_cast<double>(Real(coefficient[i]) - cycle.value(since_s))));
        }
        EXPECT_LE(worst, law) << "Q " << Q << " damping " << damping << " after " << n << " cycles";
      }
    }
  }
}

// Slips are turned on from scan to scan by a matrix: that is no worse, however finely one looks.
TEST(PropagatorAccuracy, HoldsAtAnyScanRate) {
  const sim::Motion motion = motion_at(1.0, 0.022);
  MotionRecorder recorder{350.0};
  sim::Propagator{motion, 350.0, &recorder}.skip(350);
  const Cycle50 cycle{motion, recorder.captures_s[1] - recorder.onsets_s[0]};
  const Real first_s = cycle.first_onset_s(recorder.captures_s[0]);
  for (const double rate_Hz : {20.0, 97.0, 1e4}) {
    std::vector<double> coefficient(static_cast<std::size_t>(rate_Hz));
    sim::Propagator{motion, rate_Hz}.next(coefficient);
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      const Real since_s = Real(i) / Real(rate_Hz) - first_s;
      if (since_s < 0) continue;
      // Twenty cycles of 0.06 s at up to 9/s.
      const double law = 4.0 * kEpsilon * 20.0 * 0.06 * 9.0 + 8.0 * kEpsilon;
      ASSERT_NEAR(static_cast<double>(Real(coefficient[i]) - cycle.value(since_s)), 0.0, law)
          << rate_Hz << " " << i;
    }
  }
}

// What next() gives for a scan is what at() gives for its instant, and a moment later it is no jump.
TEST(PropagatorAccuracy, ScansAndInstantsAreOneMotion) {
  for (const double damping : {0.0, 0.022, 2.0}) {
    const sim::Motion motion = motion_at(1.0, damping);
    std::vector<double> scans(2000);
    sim::Propagator{motion, 350.0}.next(scans);
    sim::Propagator at_scans{motion, 350.0};
    sim::Propagator between{motion, 350.0};
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const auto scan = static_cast<std::int64_t>(i);
      ASSERT_EQ(at_scans.at({scan, 0.0}), scans[i]) << i;
      // 1e-9 of a scan later: c′ ≤ 9/s adds 3e-11; sixteen turns of the matrix one epsilon of the swing each.
      ASSERT_NEAR(between.at({scan, 1e-9}), scans[i], 3e-11 + 16.0 * kEpsilon) << i;
    }
  }
}

}  // namespace
}  // namespace stickslip::numeric
