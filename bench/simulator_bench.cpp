// The sticking scene by the exact solver, by CVODE and by a general integrator, each at the coarsest setting
// whose error is at most 1e-9 of the coefficient. items_per_second are scans; times_exact is the time per
// scan over that of the exact solver, both measured here.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/accuracy/least_time.hpp"
#include "core/accuracy/method.hpp"
#include "core/accuracy/reference.hpp"
#include "core/base/clock.hpp"
#include "core/sim/propagator.hpp"

namespace {

using namespace stickslip;

constexpr double kScanRate_Hz = 350.0;
constexpr std::size_t kScans = 3500;  // Ten seconds.
constexpr double kAskedError = 1e-9;

sim::Motion sticking_motion() {
  sim::Motion motion;
  motion.oscillator = model::Oscillator::from_omega(2.0 * std::numbers::pi * 20.0, 0.022);
  motion.mu_s = 0.35;
  motion.mu_k = 0.30;
  motion.gravity_m_per_s2 = 9.80665;
  motion.belt = {{kScans / kScanRate_Hz, 12.0 * 0.0254 / 60.0, false}};  // As long as it is asked for.
  return motion;
}

const std::vector<double>& truth() {
  static const std::vector<double> kTruth = [] {
    std::vector<double> coefficient(kScans);
    accuracy::Reference{sticking_motion(), kScanRate_Hz}.next(coefficient);
    return coefficient;
  }();
  return kTruth;
}

double error_of(const accuracy::Method& method) {
  std::vector<double> coefficient(kScans);
  (void)method.run(sticking_motion(), kScanRate_Hz, 1, coefficient);
  return accuracy::largest_difference(coefficient, truth());
}

void run(benchmark::State& state, const accuracy::Method& method) {
  const sim::Motion motion = sticking_motion();
  std::vector<double> coefficient(kScans);
  const auto once = [&](const accuracy::Method& one) {
    (void)one.run(motion, kScanRate_Hz, 1, coefficient);
    benchmark::DoNotOptimize(coefficient.data());
  };
  for (auto _ : state) once(method);
  const auto exact = accuracy::make_exact();
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  const auto method_ns = static_cast<double>(accuracy::least_time_ns(*clock, [&] { once(method); }));
  const auto exact_ns = static_cast<double>(accuracy::least_time_ns(*clock, [&] { once(*exact); }));
  state.counters["largest_error"] = error_of(method);
  state.counters["times_exact"] = method_ns / exact_ns;
  state.SetLabel(method.setting());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kScans));
}

/// The coarsest of the settings 1e-3, 1e-4, … that is accurate enough.
template <typename Make>
std::unique_ptr<accuracy::Method> accurate_enough(const Make& make) {
  for (int digits = 3; digits < 13; ++digits) {
    std::unique_ptr<accuracy::Method> method = make(std::pow(10.0, -digits));
    if (error_of(*method) <= kAskedError) return method;
  }
  return make(1e-13);
}

void exact_solver(benchmark::State& state) { run(state, *accuracy::make_exact()); }
BENCHMARK(exact_solver);

/// A slip that begins as the one before is not solved again. Here no two are alike: S − K scatters by 1e-9.
void exact_solver_with_each_slip_solved(benchmark::State& state) {
  sim::Motion motion = sticking_motion();
  motion.paper.scatter = sim::Scatter{1e-9, 0.0};
  std::vector<double> coefficient(kScans);
  sim::Propagator sled{motion, kScanRate_Hz};
  for (auto _ : state) {
    sled.restart(1);
    sled.next(coefficient);
    benchmark::DoNotOptimize(coefficient.data());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kScans));
}
BENCHMARK(exact_solver_with_each_slip_solved);

/// An hour of the bench, 1.26 million scans, damping only.
void bench_hour(benchmark::State& state) {
  constexpr std::int64_t kHour = 3600 * 350;
  sim::Motion motion = sticking_motion();
  motion.belt.front().duration_s = 3600.0;
  sim::Propagator sled{motion, kScanRate_Hz};
  std::array<double, 4096> coefficient{};
  for (auto _ : state) {
    sled.restart(1);
    for (std::int64_t left = kHour; left > 0; left -= static_cast<std::int64_t>(coefficient.size())) {
      sled.next(std::span{coefficient}.first(
          static_cast<std::size_t>(std::min<std::int64_t>(left, coefficient.size()))));
      benchmark::DoNotOptimize(coefficient);
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kHour);
}
BENCHMARK(bench_hour)->Unit(benchmark::kMillisecond);

/// The same slips, with a belt whose speed falls so slowly that it hardly matters: the price of courses.
void exact_solver_on_a_ramp(benchmark::State& state) {
  sim::Motion motion = sticking_motion();
  motion.belt.front().acceleration_m_per_s2 = -1e-15;
  motion.belt.front().duration_s = 1e9;
  sim::Propagator sled{motion, kScanRate_Hz};
  std::array<double, kScans> coefficient{};
  for (auto _ : state) {
    sled.next(coefficient);
    benchmark::DoNotOptimize(coefficient);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(kScans));
}
BENCHMARK(exact_solver_on_a_ramp);

void cvode_at_error_1e_9(benchmark::State& state) { run(state, *accurate_enough(accuracy::make_cvode)); }
BENCHMARK(cvode_at_error_1e_9);

void peer_odeint_dopri5_at_error_1e_9(benchmark::State& state) {
  run(state, *accurate_enough(accuracy::make_dormand_prince));
}
BENCHMARK(peer_odeint_dopri5_at_error_1e_9);

void peer_euler(benchmark::State& state) {
  run(state, *accuracy::make_euler(static_cast<int>(state.range(0))));
}
BENCHMARK(peer_euler)->Arg(16)->Arg(256);

void peer_tanh_friction(benchmark::State& state) { run(state, *accuracy::make_tanh(0.01)); }
BENCHMARK(peer_tanh_friction);

}  // namespace
