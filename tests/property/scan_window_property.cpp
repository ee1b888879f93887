// What is kept from one evaluation of the capture test to the next is what would be made anew.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/detect/scan_window.hpp"
#include "core/model/capture.hpp"
#include "core/model/threshold.hpp"

namespace stickslip::model {
namespace {

double some(double low, double high) { return low + (high - low) * *rc::gen::inRange(0, 1001) / 1000.0; }

/// Q = r/(ω D), some part of the threshold.
SlipWaveform some_slip(double least_part, double most_part) {
  const double damping = *rc::gen::element(0.0, 0.005, 0.022, 0.1, 0.3);
  const double omega = some(10.0, 600.0);
  const double r = some(0.05, 5.0);
  const double Q = some(least_part, most_part) * Q_threshold(std::max(damping, 0.005));
  return {0.3, r / (omega * Q), r, Oscillator::from_omega(omega, damping)};
}

RC_GTEST_PROP(LiveCapture, FoundNearbyIsFoundAnywhere, ()) {
  const SlipWaveform slip = some_slip(0.05, 0.8);
  const double expected = capture_time_s(slip, slip.r).value();
  const double period_s = 2.0 * std::numbers::pi / slip.oscillator.omega_rad_per_s();
  const double near_s = expected + some(-0.02, 0.02) * period_s;
  const auto found = capture_time_near_s(slip, slip.r, near_s);
  RC_ASSERT(found.has_value());
  // c′ is a difference of terms as large as ω₀ D beside r: so much of ε moves its root.
  const double epsilon = std::numeric_limits<double>::epsilon();
  const double rounding = 32.0 * epsilon *
                          (slip.r + std::sqrt(slip.oscillator.omega0_squared()) * std::abs(slip.D)) /
                          slip.acceleration(expected);
  RC_ASSERT(std::abs(*found - expected) <= rounding + 8.0 * epsilon * expected);
}

RC_GTEST_PROP(LiveCapture, IsNotFoundNearAPlaceWhereThereIsNone, ()) {
  const double damping = *rc::gen::element(0.005, 0.022, 0.1, 0.3);
  const double omega = some(10.0, 600.0);
  const double r = some(0.05, 5.0);
  const double Q = some(1.02, 4.0) * Q_threshold(damping);
  const SlipWaveform slip{0.3, r / (omega * Q), r, Oscillator::from_omega(omega, damping)};
  RC_ASSERT(!capture_time_s(slip, r));
  RC_ASSERT(!capture_time_near_s(slip, r, slip.rise_end_time_s() + some(-0.2, 0.2) / omega));
}

RC_GTEST_PROP(ScanWindow, LaidOutScanByScanAreThoseOfAllScansAtOnce, (std::uint64_t seed)) {
  const double scan_s = 1.0 / *rc::gen::element(50.0, 350.0, 2000.0, 20'000.0);
  SharedParameters shared;
  shared.omega = some(60.0, 200.0);
  shared.gamma = some(0.0, 20.0);
  shared.r = 0.5;
  const double from_s = some(0.0, 0.1);
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0.3, 0.01};
  std::bernoulli_distribution is_spike{0.05};
  estimate::CycleBuffer buffer;
  detect::ScanWindow step_by_step;
  const auto scans = static_cast<int>(0.4 / scan_s);
  std::uniform_int_distribution<int> evaluation{0, 2 + scans / 100};
  for (int i = 0; i < scans; ++i) {
    if (is_spike(random)) continue;
    buffer.add(i * scan_s, noise(random));
    const auto points = buffer.since(from_s);
    // Evaluations do not come with each scan, and noise is measured anew now and then.
    if (points.empty() || evaluation(random) > 2) continue;
    const double sigma = i < scans / 2 ? 0.01 : 0.011;
    const auto before = std::vector<detect::ScanRow>(step_by_step.all().begin(), step_by_step.all().end());
    const std::size_t kept = step_by_step.lay_out(points, shared, sigma);
    detect::ScanWindow at_once;
    RC_ASSERT(at_once.lay_out(points, shared, sigma) == 0U);
    RC_ASSERT(step_by_step.size() == at_once.size());
    RC_ASSERT(kept <= std::min(before.size(), at_once.size()));
    for (std::size_t row = 0; row < at_once.size(); ++row) {
      const detect::ScanRow& one = step_by_step.all()[row];
      const detect::ScanRow& other = at_once.all()[row];
      RC_ASSERT(one.tau_s == other.tau_s && one.value == other.value && one.scale == other.scale);
      RC_ASSERT(one.by_D == other.by_D && one.by_rate == other.by_rate);
      RC_ASSERT(one.half_spread_s2 == other.half_spread_s2 && one.stray == other.stray);
      if (row < kept) RC_ASSERT(before[row].value == one.value && before[row].scale == one.scale);
    }
  }
}

// Up to three outliers are left out, if no more than one scan in five is one: more of them are a trajectory
// that does not describe the scans.
TEST(ScanWindow, OutliersAreLeftOutWhereTheyAreFew) {
  SharedParameters shared;
  shared.omega = 100.0;
  shared.r = 0.5;
  for (const std::size_t outliers : {1U, 3U, 4U, 8U, 9U, 20U}) {
    estimate::CycleBuffer buffer;
    for (int i = 0; i < 40; ++i) buffer.add(0.002 * i, 0.0);
    detect::ScanWindow window;
    static_cast<void>(window.lay_out(buffer.points(), shared, 0.01));
    ASSERT_EQ(window.size(), 40U);
    std::size_t marked = 0;
    while (window.leave_out_a_stray(0, window.size(), [&](const detect::ScanRow& row) {
      const auto place = static_cast<std::size_t>(&row - window.all().data());
      return !row.stray && place % 2 == 1 && place / 2 < outliers ? 6.0 + static_cast<double>(place) : 1.0;
    }))
      ++marked;
    EXPECT_EQ(marked, outliers > 8 ? 0U : std::min<std::size_t>(outliers, 3));
  }
}

}  // namespace
}  // namespace stickslip::model
