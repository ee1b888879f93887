// The exact propagator beside a general integrator on the sticking scene: time per scan, and the
// peer's error against the propagator after one second. items_per_second are scans.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <boost/numeric/odeint.hpp>

#include "core/sim/propagator.hpp"

namespace {

using stickslip::friction::Oscillator;
using stickslip::sim::Motion;
using stickslip::sim::Propagator;

constexpr double kScanRate_Hz = 350.0;
constexpr std::size_t kScans = 350;  // One second.

Motion sticking_motion() {
  Motion motion;
  motion.oscillator = Oscillator::from_omega(2.0 * std::numbers::pi * 20.0, 0.022);
  motion.mu_s = 0.35;
  motion.mu_k = 0.30;
  motion.gravity_m_per_s2 = 9.80665;
  motion.belt = {{1e9, 12.0 * 0.0254 / 60.0, false}};
  return motion;
}

void exact_propagator(benchmark::State& state) {
  Propagator sled{sticking_motion(), kScanRate_Hz};
  std::array<double, kScans> coefficient{};
  for (auto _ : state) {
    sled.next(coefficient);
    benchmark::DoNotOptimize(coefficient);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kScans));
}
BENCHMARK(exact_propagator);

using State = std::array<double, 2>;  // c, c′

/// Dormand–Prince 5(4) scan by scan, modes switched by bisection on the dense output of each scan.
std::vector<double> integrate_generally(const Motion& motion, double tolerance) {
  namespace odeint = boost::numeric::odeint;
  const Oscillator& tester = motion.oscillator;
  const double r = tester.stick_rate_per_s(motion.belt.front().speed_m_per_s, motion.gravity_m_per_s2);
  const auto slip = [&](const State& x, State& dx, double) {
    dx = {x[1], -tester.gamma_per_s * x[1] - tester.omega0_squared() * (x[0] - motion.mu_k)};
  };
  const auto advance = [&](State x, double duration) {
    if (duration > 0.0) {
      odeint::integrate_adaptive(
          odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>()), slip, x, 0.0,
          duration, duration);
    }
    return x;
  };
  std::vector<double> coefficient;
  // The belt starts at once: the sled slips until it has caught up.
  State x{0.0, 0.0};
  bool sticks = false;
  bool fast = true;  // c′ has been well below r, so that reaching it again is a capture.
  for (std::size_t scan = 0; scan < kScans; ++scan) {
    coefficient.push_back(x[0]);
    double left = 1.0 / kScanRate_Hz;
    while (left > 0.0) {
      if (sticks) {
        const double until = std::min(left, (motion.mu_s - x[0]) / r);
        x[0] += r * until;
        left -= until;
        if (left > 0.0) sticks = fast = false;
        continue;
      }
      const State end = advance(x, left);
      fast = fast || end[1] < 0.0;
      if (!fast || end[1] < r) {
        x = end;
        break;
      }
      double low = 0.0;
      double high = left;
      while (high - low > 1e-14) {
        const double middle = 0.5 * (low + high);
        (advance(x, middle)[1] < r ? low : high) = middle;
      }
      x = advance(x, high);
      x[1] = r;
      left -= high;
      sticks = true;
    }
  }
  return coefficient;
}

void peer_odeint_dopri5(benchmark::State& state) {
  const Motion motion = sticking_motion();
  const double tolerance = std::pow(10.0, -static_cast<double>(state.range(0)));
  std::vector<double> coefficient;
  for (auto _ : state) {
    coefficient = integrate_generally(motion, tolerance);
    benchmark::DoNotOptimize(coefficient.data());
  }
  Propagator sled{motion, kScanRate_Hz};
  std::array<double, kScans> exact{};
  sled.next(exact);
  double error = 0.0;
  for (std::size_t i = 0; i < kScans; ++i) error = std::max(error, std::abs(coefficient[i] - exact[i]));
  state.counters["largest_error"] = error;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kScans));
}
BENCHMARK(peer_odeint_dopri5)->Arg(3)->Arg(6)->Arg(9)->Arg(12);

}  // namespace
