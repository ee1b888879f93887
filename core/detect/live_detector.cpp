#include "core/detect/live_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/signal/statistics.hpp"

namespace stickslip::detect {
namespace {

/// As for the whole test: a trace without noise still has rounding.
constexpr double kSmallestNoise = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

LiveDetector::LiveDetector(const LiveSettings& settings)
    : settings_(settings),
      noise_(std::max(signal::kRoundingSigma * settings.step_coefficient, kSmallestNoise)),
      usable_noise_(noise_),
      follower_(settings.estimator, settings.scan_rate_Hz, settings.prior),
      positions_(settings.scan_rate_Hz) {}

std::optional<LiveCycle> LiveDetector::follow(const signal::DespikedScan& scan, bool saturated) {
  const double sigma = noise_.known() ? noise_.sigma() : kInfinity;
  // The despiker still held scans from before the gap when it was told.
  if (positions_.is_at_gap()) follow_gap();
  const auto position = static_cast<double>(positions_.follow());
  if (scan.spike) flags_.mark(kCycleHasSpike);
  if (saturated) flags_.mark(kCycleIsSaturated);
  flags_.add(scan.value);
  const bool usable = !scan.spike && !saturated;
  if (usable) {
    follower_.add(positions_.time_s(position), scan.value);
    usable_noise_.add(scan.value);
  } else {
    usable_noise_.gap();
  }
  const auto amplitude = watch_.add(scan.value, usable);

  const bool was_falling = finder_.falling();
  const auto fall = finder_.add(scan.value, SlipRule::kHysteresisSigmas * sigma);
  if (finder_.falling()) {
    follower_.falls(positions_.time_s(static_cast<double>(finder_.high_at())),
                    positions_.time_s(static_cast<double>(finder_.low_at())));
  }
  if (state_.phase < Phase::kCycles && usable) watch_phase(scan.value, sigma);
  // What falls before anything was loaded are spikes that follow each other.
  if (!was_falling && finder_.falling() && loading_.is_behind_begin(static_cast<double>(finder_.high_at())))
    fall_begun_ = {static_cast<base::ScanIndex>(finder_.high_at()), finder_.high(),
                   positions_.count_come() - 1};
  if (fall && rule_.is_slip(*fall, sigma) && loading_.is_behind_begin(fall->peak_at))
    return slip(*fall, positions_.time_s(position));
  if (follower_.step(positions_.time_s(position), usable_sigma())) take_decision();
  if (amplitude && amplitude->is_over()) {
    watch_.stop();
    state_.regime = model::Regime::kSteadySliding;
    return close();
  }
  return std::nullopt;
}

void LiveDetector::watch_phase(double value, double sigma) noexcept {
  if (state_.phase == Phase::kIdle) {
    if (loading_.add(value, sigma, positions_.count_followed())) state_.phase = Phase::kLoading;
    return;
  }
  if (state_.phase == Phase::kLoading && finder_.falling()) state_.phase = Phase::kFirstSlip;
  // What fell was none.
  if (state_.phase == Phase::kFirstSlip && !finder_.falling() && state_.slip_count == 0)
    state_.phase = Phase::kLoading;
}

std::optional<LiveCycle> LiveDetector::slip(const Fall& fall, double now_s) noexcept {
  if (follower_.is_open() && follower_.force(now_s, usable_sigma(), true)) take_decision();
  // The cycle before reaches from its peak to this one.
  const double peak_s = positions_.time_s(fall.peak_at);
  if (follower_.is_open()) {
    flags_.end_cycle_at_peak();
    LiveCycle& before = follower_.slip();
    before.cycle.period_s = peak_s - before.cycle.peak_time_s;
  }
  std::optional<LiveCycle> closed = close();
  const bool begins_from_stick = state_.regime != model::Regime::kRingDown;
  follower_.open(fall, peak_s, positions_.time_s(fall.trough_at), begins_from_stick, usable_sigma());
  if (state_.phase < Phase::kFirstSlip) state_.phase = Phase::kFirstSlip;
  ++state_.slip_count;
  flags_.begin_cycle();
  return closed;
}

void LiveDetector::take_decision() noexcept {
  if (state_.phase == Phase::kFirstSlip) state_.phase = Phase::kCycles;
  if (follower_.captured()) {
    state_.regime = model::Regime::kStickSlip;
    watch_.stop();
    return;
  }
  state_.regime = model::Regime::kRingDown;
  if (!watch_.running())
    watch_.start(follower_.shared().omega, follower_.shared().gamma, settings_.scan_rate_Hz);
}

std::optional<LiveCycle> LiveDetector::close() noexcept {
  if (!follower_.is_open()) return std::nullopt;
  std::optional<LiveCycle> closed{follower_.slip()};
  Cycle& cycle = closed->cycle;
  cycle.flags |= flags_.of_cycle();
  cycle.number = state_.slip_count - 1;
  if (cycle.number == 0) cycle.flags |= kCycleIsFirst;
  // The scan's number in the acquisition is the caller's to add.
  cycle.first_scan = std::llround(cycle.peak_time_s * settings_.scan_rate_Hz);
  follower_.close();
  state_.latest = closed;
  return closed;
}

void LiveDetector::follow_gap() noexcept {
  flags_.mark(kCycleHasGap);
  const double last_s = positions_.time_s(static_cast<double>(positions_.count_followed() - 1));
  follower_.gap(last_s);
  usable_noise_.gap();
  if (watch_.running())
    watch_.start(follower_.shared().omega, follower_.shared().gamma, settings_.scan_rate_Hz);
}

void LiveDetector::gap(std::int64_t count) noexcept {
  noise_.gap();
  // Of two gaps with so few scans in between that the despiker holds them all, the first is not waited for.
  if (positions_.is_gap_to_come() && !positions_.continues_gap()) follow_gap();
  positions_.add_gap(count);
}

std::optional<LiveCycle> LiveDetector::end() noexcept {
  const double now_s = positions_.time_s(static_cast<double>(positions_.count_followed()));
  if (follower_.is_open() && follower_.force(now_s, usable_sigma(), false)) take_decision();
  // The despiker still holds the scans behind it, or none came.
  if (positions_.is_gap_to_come()) flags_.mark(kCycleHasGap);
  flags_.end_test();
  state_.phase = Phase::kEnd;
  return close();
}

}  // namespace stickslip::detect
