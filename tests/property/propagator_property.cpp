// What holds for every tester and paper, however odd.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/sim/propagator.hpp"
#include "core/sim/random_stream.hpp"

namespace stickslip::sim {
namespace {

/// A number between two limits, drawn from a grid so that 0 and equal values occur too.
double some_number(double low, double high) { return low + (high - low) * *rc::gen::inRange(0, 101) / 100.0; }

BeltSegment some_segment() {
  BeltSegment segment;
  segment.duration_s = some_number(0.0, 2.0);
  segment.speed_m_per_s = some_number(-0.05, 0.05);
  segment.halt_when_unloaded = *rc::gen::arbitrary<bool>();
  if (*rc::gen::inRange(0, 3) == 0) {
    segment.acceleration_m_per_s2 = *rc::gen::element(1e-9, 1e-3, 0.05, 1.0, 10.0) * some_number(-1.0, 1.0);
    if (segment.acceleration_m_per_s2 > 0.1 || segment.acceleration_m_per_s2 < -0.1)
      segment.duration_s /= 50.0;
  }
  if (*rc::gen::inRange(0, 5) == 0) segment.jerk_m_per_s3 = some_number(-0.05, 0.05);
  if (*rc::gen::inRange(0, 4) == 0) {
    segment.decaying_speed_m_per_s =
        *rc::gen::arbitrary<bool>() ? -segment.speed_m_per_s : some_number(-0.05, 0.05);
    segment.time_constant_s = *rc::gen::element(0.003, 0.1, 1.0, 1e4);
  }
  return segment;
}

Motion some_motion() {
  Motion motion;
  const double omega0_squared = std::pow(some_number(5.0, 500.0), 2);
  // Up to twice the critical damping.
  motion.oscillator = model::Oscillator::from_omega0(
      omega0_squared,
      *rc::gen::element(0.0, 0.01, 0.044, 0.5, 1.9, 2.0, 2.1, 4.0) * std::sqrt(omega0_squared));
  motion.mu_k = some_number(0.0, 1.0);
  motion.mu_s = motion.mu_k + some_number(0.0, 1.0);
  motion.gravity_m_per_s2 = 9.80665;
  motion.one_way_coupling = *rc::gen::arbitrary<bool>();
  motion.damper_counts_at_onset = *rc::gen::inRange(0, 4) == 0;
  if (motion.one_way_coupling && *rc::gen::arbitrary<bool>()) motion.startup_slack_m = some_number(0.0, 0.01);
  const int segments = *rc::gen::inRange(1, 6);
  for (int i = 0; i < segments; ++i) motion.belt.push_back(some_segment());
  if (*rc::gen::inRange(0, 3) == 0) motion.paper.contact_ageing = ContactAgeing{some_number(0.0, 0.1), 1e-3};
  if (*rc::gen::arbitrary<bool>()) {
    KineticDrift drift;
    drift.form = *rc::gen::element(KineticDrift::Form::kLinear, KineticDrift::Form::kExponential);
    drift.over = *rc::gen::element(KineticDrift::Over::kTime, KineticDrift::Over::kBeltTravel);
    drift.scale = drift.over == KineticDrift::Over::kTime ? *rc::gen::element(0.01, 3.0, 20.0) : 0.7;
    drift.change = some_number(-0.3, 0.3);
    if (drift.form == KineticDrift::Form::kLinear && drift.over == KineticDrift::Over::kTime)
      drift.scale = 20.0;
    motion.kinetic_drift = drift;
    if (!has_closed_form(motion)) motion.kinetic_drift.reset();
  }
  return motion;
}

RC_GTEST_PROP(PropagatorProperty, ResultDoesNotDependOnHowReadsAreSplit, ()) {
  const Motion motion = some_motion();
  std::vector<double> whole(1500);
  Propagator{motion, 350.0}.next(whole);
  std::vector<double> parts(whole.size());
  Propagator sled{motion, 350.0};
  for (std::size_t first = 0; first < parts.size();) {
    const auto count = std::min<std::size_t>(parts.size() - first, *rc::gen::inRange<std::size_t>(1, 400));
    sled.next(std::span{parts}.subspan(first, count));
    first += count;
  }
  RC_ASSERT(whole == parts);
}

// The events are solved for, not sampled: a finer scan sees the same motion.
RC_GTEST_PROP(PropagatorProperty, ResultDoesNotDependOnTheScanRate, ()) {
  const Motion motion = some_motion();
  std::vector<double> coarse(700);
  std::vector<double> fine(4 * coarse.size());
  Propagator{motion, 256.0}.next(coarse);
  Propagator{motion, 1024.0}.next(fine);  // A power of two: the same moments to the last bit.
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    RC_ASSERT(std::abs(coarse[i] - fine[4 * i]) < 1e-6);
  }
}

// Energy: the spring never holds more than the start of a slip gave it, and the belt adds at most one
// amplitude of catching up at each change of speed.
RC_GTEST_PROP(PropagatorProperty, ForceStaysFiniteAndOneWayCouplingNeverPushes, ()) {
  const Motion motion = some_motion();
  std::vector<double> coefficient(3500);
  Propagator{motion, 350.0}.next(coefficient);
  const double most_rate = motion.oscillator.stick_rate_per_s(0.05, motion.gravity_m_per_s2);
  const double swing = 2.0 * most_rate / std::sqrt(motion.oscillator.omega0_squared());
  const double bound = motion.mu_s + (1.0 + static_cast<double>(motion.belt.size())) * (swing + motion.mu_s);
  for (const double c : coefficient) {
    RC_ASSERT(std::isfinite(c));
    RC_ASSERT(std::abs(c) <= bound);
    if (motion.one_way_coupling) RC_ASSERT(c >= 0.0);
  }
}

// Events take time: a motion that alternated for ever within one moment would never get here.
RC_GTEST_PROP(PropagatorProperty, NumberOfEventsIsBoundedByTheOscillator, ()) {
  struct Counter final : MotionObserver {
    void mode_began(const ModeStart& /*start*/) override { ++count; }
    double count = 0.0;
  } counter;
  const Motion motion = some_motion();
  Propagator sled{motion, 350.0, &counter};
  sled.skip(3500);
  const double cycles = 10.0 * std::sqrt(motion.oscillator.omega0_squared()) / 6.0;
  RC_ASSERT(counter.count <= 10.0 + 10.0 * static_cast<double>(motion.belt.size()) + 12.0 * cycles);
}

RC_GTEST_PROP(RandomStreamProperty, NamesAndNumbersGiveDifferentSeeds, (std::uint64_t seed)) {
  RC_ASSERT(stream_seed(seed, "white_noise") != stream_seed(seed, "quantisation"));
  RC_ASSERT(stream_seed(seed, std::uint64_t{0}) != stream_seed(seed, std::uint64_t{1}));
  RC_ASSERT(stream_seed(seed, "white_noise") != stream_seed(seed + 1, "white_noise"));
}

}  // namespace
}  // namespace stickslip::sim
