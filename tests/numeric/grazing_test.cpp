// Hard case 4: the capture that is only just reached, by every solver.
#include "core/accuracy/grazing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/accuracy/reference.hpp"
#include "core/model/threshold.hpp"
#include "tests/numeric/constants.hpp"
#include "tests/numeric/motion_recorder.hpp"

namespace stickslip::numeric {
namespace {

/// Captures within the first seconds after the first onset.
std::int64_t exact_captures(const sim::Motion& motion, std::int64_t scans) {
  MotionRecorder recorder{kRate_Hz};
  sim::Propagator{motion, kRate_Hz, &recorder}.skip(scans);
  return std::count_if(recorder.captures_s.begin(), recorder.captures_s.end(), [&](double capture_s) {
    return !recorder.onsets_s.empty() && capture_s > recorder.onsets_s.front();
  });
}

// c′(t₃) − r is about r (1 − Q/Q_th) and is computed to some ε r: sixteen digits less three leave n = 13.
TEST(Grazing, EachSideOfTheThresholdHasItsRegimeToThirteenDigits) {
  for (const double damping : {0.001, 0.022, 0.3}) {
    const double Q_th = model::Q_threshold(damping);
    for (int n = 2; n <= 13; ++n) {
      const double step = std::pow(10.0, -n);
      const sim::Motion below = accuracy::grazing_motion(damping, Q_th * (1.0 - step));
      const sim::Motion above = accuracy::grazing_motion(damping, Q_th * (1.0 + step));
      EXPECT_GE(exact_captures(below, 3500), 50) << damping << ' ' << n;
      EXPECT_EQ(exact_captures(above, 3500), 0) << damping << ' ' << n;
      // What 50 digits say.
      accuracy::Reference truth_below{below, kRate_Hz};
      truth_below.skip(700);
      EXPECT_GE(truth_below.capture_count(), 3) << damping << ' ' << n;
      accuracy::Reference truth_above{above, kRate_Hz};
      truth_above.skip(700);
      EXPECT_EQ(truth_above.capture_count(), 1) << damping << ' ' << n;  // Catching up with the belt.
    }
  }
}

// Near t₃ the rate is r + δ − |c‴| (t₃ − t)²/2, with δ = r (1 − Q/Q_th). What rounding does to it, a few ε r,
// moves the root by that over the slope |c‴| τ, τ = t₃ − t_e, and by √(2 · few ε r/|c‴|) at the most: the
// slope is ω² r τ or so, and ω τ = 0.67 √(1 − Q/Q_th).
TEST(Grazing, CaptureTimesKeepToTheSquareRootLimit) {
  constexpr double kFewRoundings = 64.0;
  for (const double damping : {0.005, 0.022, 0.1}) {
    const double Q_th = model::Q_threshold(damping);
    for (int n = 1; n <= 13; ++n) {
      const double below = std::pow(10.0, -n);
      const sim::Motion motion = accuracy::grazing_motion(damping, Q_th * (1.0 - below));
      MotionRecorder recorder{kRate_Hz};
      sim::Propagator{motion, kRate_Hz, &recorder}.skip(700);
      ASSERT_GE(recorder.captures_s.size(), 2U);
      ASSERT_GE(recorder.onsets_s.size(), 1U);
      accuracy::Reference reference{motion, kRate_Hz};
      while (reference.capture_count() < 2) reference.skip(1);
      const double truth_s =
          static_cast<double>(accuracy::Real(*reference.last_capture_s() - *reference.last_onset_s()));
      const double by_slope = kFewRoundings * kEpsilon / (0.67 * std::sqrt(below));
      const double by_curvature = std::sqrt(2.0 * kFewRoundings * kEpsilon);
      // Times of some 0.3 s are written to 1e-16 s.
      EXPECT_NEAR((recorder.captures_s[1] - recorder.onsets_s[0]) * kOmega, truth_s * kOmega,
                  std::fmin(by_slope, by_curvature) + kFewRoundings * kEpsilon)
          << damping << ' ' << n;
    }
  }
}

TEST(Grazing, ExactTableIsFoundThroughout) {
  std::vector<std::unique_ptr<accuracy::Method>> methods;
  methods.push_back(accuracy::make_exact());
  for (const accuracy::GrazingRow& row : accuracy::grazing_table(0.022, methods)) {
    for (const accuracy::Grazing step : row.steps) EXPECT_EQ(step, accuracy::Grazing::kFound);
  }
}

// CVODE knows its accuracy, so it knows which captures it cannot judge: each step of the table is right or
// undecided, and right as long as the excess of c′ over r, about r(1 − Q/Q_th), is well above the accuracy.
TEST(Grazing, CvodeIsRightOrSaysThatItCannotTell) {
  std::vector<std::unique_ptr<accuracy::Method>> methods;
  for (const int digits : {3, 6, 9, 12}) methods.push_back(accuracy::make_cvode(std::pow(10.0, -digits)));
  const std::vector<accuracy::GrazingRow> table = accuracy::grazing_table(0.022, methods);
  // r/ω₀ = 0.1, and a digit to spare; of the 1e-12 asked CVODE has 6e-11 in use, its floor.
  const std::array<int, 4> surely_found{1, 4, 7, 8};
  for (std::size_t row = 0; row < table.size(); ++row) {
    for (int n = 1; n <= accuracy::kFinestStep; ++n) {
      const accuracy::Grazing step = table[row].steps[static_cast<std::size_t>(n - 1)];
      EXPECT_TRUE(step == accuracy::Grazing::kFound || step == accuracy::Grazing::kUndecided)
          << table[row].setting << ", n = " << n << ": " << accuracy::name(step);
      if (n <= surely_found[row]) {
        EXPECT_EQ(step, accuracy::Grazing::kFound) << table[row].setting << ' ' << n;
      }
    }
  }
}

// With dense output and a look at c″ = 0 a general integrator finds what rises inside a step, as far as its
// c′ is right: c′/r to about ten times the tolerance, and steps add up to another ten.
TEST(Grazing, OdeintIsRightDownToItsTolerance) {
  std::vector<std::unique_ptr<accuracy::Method>> methods;
  std::vector<int> digits;
  for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer}) {
    for (const int digit : {5, 7, 9, 11, 13}) {
      methods.push_back(make(std::pow(10.0, -digit)));
      digits.push_back(digit);
    }
  }
  const std::vector<accuracy::GrazingRow> table = accuracy::grazing_table(0.022, methods);
  for (std::size_t row = 0; row < table.size(); ++row) {
    for (int n = 1; n <= digits[row] - 3; ++n) {
      EXPECT_EQ(table[row].steps[static_cast<std::size_t>(n - 1)], accuracy::Grazing::kFound)
          << table[row].method << ", " << table[row].setting << ", n = " << n;
    }
  }
}

// At 1e-2 a step of Bulirsch and Stoer's takes 0.9 of an oscillation: the capture lies inside it, between two
// extremes of c′ that a look at the whole step cancels.
TEST(Grazing, OdeintMissesNoCaptureInALongStep) {
  const double Q_th = model::Q_threshold(0.022);
  for (const double part : {0.6, 0.75, 0.9}) {
    EXPECT_EQ(accuracy::goes_on(*accuracy::make_bulirsch_stoer(1e-2), 0.022, part * Q_th),
              accuracy::GoesOn::kYes)
        << part;
  }
}

// Beyond that one of the two sides is wrong, and nothing tells: it has no estimate of its own error.
TEST(Grazing, OdeintDoesNotSayWhereItCannotTell) {
  std::vector<std::unique_ptr<accuracy::Method>> methods;
  for (const auto make : {accuracy::make_dormand_prince, accuracy::make_bulirsch_stoer})
    methods.push_back(make(1e-9));
  for (const accuracy::GrazingRow& row : accuracy::grazing_table(0.022, methods)) {
    for (int n = 11; n <= accuracy::kFinestStep; ++n) {
      const accuracy::Grazing step = row.steps[static_cast<std::size_t>(n - 1)];
      EXPECT_TRUE(step == accuracy::Grazing::kMissed || step == accuracy::Grazing::kFalse)
          << row.method << ", n = " << n << ": " << accuracy::name(step);
    }
  }
}

// A method of order 1 has c′ wrong by some h ω r, so its threshold is off by some h ω: at 64 steps a scan,
// 0.6 %. It cannot tell the sides at n = 5, but does well at a factor of 1.5.
TEST(Grazing, EulerCannotTellTheSides) {
  const double Q_th = model::Q_threshold(0.022);
  const auto euler = accuracy::make_euler(64);
  EXPECT_EQ(accuracy::goes_on(*euler, 0.022, Q_th / 1.5), accuracy::GoesOn::kYes);
  EXPECT_EQ(accuracy::goes_on(*euler, 0.022, Q_th * 1.5), accuracy::GoesOn::kNo);
  EXPECT_EQ(accuracy::goes_on(*euler, 0.022, Q_th * (1.0 - 1e-5)),
            accuracy::goes_on(*euler, 0.022, Q_th * (1.0 + 1e-5)));
}

// Smooth friction never holds S but only the maximum S′ of its curve, and what it holds is spring and damper
// together: slip starts at D′ = S′ − K − γr/ω₀². In the limit of zero width the threshold is that of D′:
//     Q D = Q_th (S′ − K − (γ/ω₀²) ω Q D)  →  Q = Q_th (S′ − K)/D / (1 + Q_th γω/ω₀²) = 0.76 instead of 1.94.
// The way there is slow: slip begins late by w^(2/3), as at any fold.
TEST(Grazing, SmoothFrictionConvergesToAnotherThreshold) {
  constexpr double kDamping = 0.022;
  const sim::Motion motion = accuracy::grazing_motion(kDamping, 1.0);
  double most = 0.0;
  for (double z = 0.0; z < 10.0; z += 1e-3) {
    const double stribeck = z / accuracy::kStribeckOverTanh;
    most = std::fmax(
        most, (motion.mu_k + (motion.mu_s - motion.mu_k) * std::exp(-stribeck * stribeck)) * std::tanh(z));
  }
  const double Q_th = model::Q_threshold(kDamping);
  const model::Oscillator& tester = motion.oscillator;
  const double predicted =
      Q_th * (most - motion.mu_k) / (motion.mu_s - motion.mu_k) /
      (1.0 + Q_th * tester.gamma_per_s * tester.omega_rad_per_s() / tester.omega0_squared());
  EXPECT_NEAR(predicted, 0.76, 0.01);

  const double wide = accuracy::apparent_threshold(*accuracy::make_tanh(1e-3), kDamping, 0.6, 1.1, 0.004);
  const double narrow = accuracy::apparent_threshold(*accuracy::make_tanh(2.5e-4), kDamping, 0.6, 1.1, 0.004);
  EXPECT_LT(narrow, wide);
  EXPECT_LT(wide, 0.5 * Q_th);
  const double fold = std::pow(4.0, 2.0 / 3.0);
  // Two bisections of ± 0.002, the second taken 1.7 times, and the next power of the width.
  EXPECT_NEAR((fold * narrow - wide) / (fold - 1.0), predicted, 0.02);
}

}  // namespace
}  // namespace stickslip::numeric
