#include "core/pipeline/segmenter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/detect/slip_rule.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::pipeline {
namespace {

using detect::SlipRule;

/// Smallest noise assumed, relative to the trigger, for scenes without noise.
constexpr double kSmallestRelativeNoise = 1e-4;
/// Time constant, in scans, of the average by which a flat force is detected.
constexpr double kSmoothing = 8.0;
/// Smallest last fall, relative to the largest and in σ, after which a stop of the belt is accepted. The last
/// significant fall of a decaying oscillation is smaller.
constexpr double kFullSwing = 0.5;
constexpr double kFullSwingSigmas = 2.0 * SlipRule::kSignificantSigmas;
constexpr int kFewestFalls = 2;
/// Number of periods without a fall after which the oscillation has stopped.
constexpr double kMissingPeriods = 4.0;

double noise_floor(const SegmenterSettings& settings) {
  return std::max(signal::kRoundingSigma * settings.step_coefficient,
                  kSmallestRelativeNoise * settings.start_coefficient);
}

void require(bool condition, const char* what, double value) {
  if (!condition) throw std::invalid_argument(fmt::format("{}: {}", what, value));
}

}  // namespace

std::size_t SegmenterSettings::pre_trigger_scans() const noexcept {
  return static_cast<std::size_t>(std::llround(pre_trigger_s * scan_rate_Hz));
}

Segmenter::Segmenter(const SegmenterSettings& settings)
    : settings_(settings),
      quiet_scans_(
          settings.scan_rate_Hz,
          std::max({UnloadedLevel::kQuiet_s, 1.25 * settings.pre_trigger_s, 2.0 * settings.unload_dwell_s}),
          settings.step_coefficient),
      end_scans_(settings.scan_rate_Hz, settings.unload_dwell_s, settings.step_coefficient),
      level_(settings.unloaded_level && UnloadedLevel::fits(*settings.unloaded_level)
                 ? settings.unloaded_level
                 : std::nullopt),
      level_is_given_(level_.has_value()),
      noise_(noise_floor(settings)) {
  require(settings.scan_rate_Hz > 0.0, "scan rate in Hz must be positive", settings.scan_rate_Hz);
  require(settings.start_dwell_s > 0.0, "start dwell in s must be positive", settings.start_dwell_s);
  require(settings.unload_dwell_s > 0.0, "unload dwell in s must be positive", settings.unload_dwell_s);
  require(settings.no_motion_dwell_s > 0.0, "no-motion dwell in s must be positive",
          settings.no_motion_dwell_s);
  require(settings.pre_trigger_s >= 0.0, "pre-trigger time in s must not be negative",
          settings.pre_trigger_s);
  require(settings.end_coefficient >= 0.0 && settings.end_coefficient < settings.start_coefficient,
          "end coefficient must be from 0 to below the start coefficient", settings.end_coefficient);
}

std::int64_t Segmenter::scans(double seconds) const noexcept {
  return std::max<std::int64_t>(2, std::llround(seconds * settings_.scan_rate_Hz));
}

bool Segmenter::arm() {
  by_force_ = true;
  const bool was_there = was_above();
  if (was_there) {
    waiting_.clear();
    above_ = 0;
  }
  return was_there;
}

void Segmenter::start() noexcept { start_now_ = state_ == State::kReady; }

void Segmenter::stop() noexcept {
  start_now_ = false;
  if (state_ != State::kRunning) return;
  // As for a stop by force: what is left of the force is no beginning of the next test.
  if (below_ >= scans(settings_.unload_dwell_s)) {
    state_ = State::kReady;
  } else {
    wait_for_unload(std::max(largest_, end_tail_.empty() ? 0.0 : end_tail_.back()));
  }
}

void Segmenter::wait_for_unload(double force) noexcept {
  state_ = State::kWaitingForUnload;
  pulled_again_ = false;
  smooth_ = lowest_ = force;
}

bool Segmenter::pulls_again(double coefficient) noexcept {
  smooth_ += (coefficient - smooth_) / kSmoothing;
  lowest_ = std::min(lowest_, smooth_);
  if (pulled_again_) return false;
  pulled_again_ = UnloadedLevel::fits_after(lowest_, largest_, level_.value_or(0.0)) &&
                  smooth_ >= lowest_ + settings_.start_coefficient;
  return pulled_again_;
}

std::optional<double> Segmenter::level_at_end() {
  end_scans_.clear();
  std::optional<double> level;
  for (const double coefficient : end_tail_) {
    end_scans_.add(coefficient);
    level = end_scans_.news();
  }
  return level;
}

Segmenter::Event Segmenter::observe(base::ScanIndex index, double coefficient) {
  if (next_ && index != *next_ && state_ == State::kReady) {
    waiting_.clear();
    above_ = 0;
  }
  if (next_ && index != *next_) {
    quiet_scans_.clear();
    negative_ = 0;
  }
  next_ = index + 1;
  quiet_scans_.add(coefficient);
  if (state_ == State::kReady) track();
  above_ = coefficient >= trigger() ? above_ + 1 : 0;
  below_ = coefficient < base() + settings_.end_coefficient ? below_ + 1 : 0;
  negative_ = coefficient <= base() - settings_.start_coefficient ? negative_ + 1 : 0;
  const bool is_negative =
      negative_ == scans(settings_.unload_dwell_s) && !std::exchange(may_push_back_, false);
  const bool unloaded = below_ >= scans(settings_.unload_dwell_s);

  switch (state_) {
    case State::kWaitingForUnload:
      if (unloaded || lies_unloaded()) {
        state_ = State::kReady;
        return Event::kNone;
      }
      return pulls_again(coefficient) ? Event::kPulledAgain : Event::kNone;
    case State::kReady:
      waiting_.push_back(coefficient);
      if (start_now_ || (by_force_ && loaded())) {
        begin();
        return Event::kTestStarts;
      }
      if (waiting_.size() > settings_.pre_trigger_scans()) waiting_.pop_front();
      return by_force_ && is_negative ? Event::kNegative : Event::kNone;
    case State::kRunning:
      follow(coefficient);
      if (!was_loaded_ && loaded()) {
        was_loaded_ = may_push_back_ = true;
        quiet_scans_.clear();  // The rest before the load is no unloading.
      }
      end_tail_.push_back(coefficient);
      if (end_tail_.size() > end_scans_.stretch_scans()) end_tail_.pop_front();
      if (was_loaded_ && (unloaded || lies_unloaded())) {
        level_after_ = quiet_scans_.news() ? quiet_scans_.news() : level_at_end();
        state_ = State::kReady;
        return Event::kUnloaded;
      }
      if (belt_has_stopped()) {
        wait_for_unload(std::min(smooth_, flat_level_));
        return Event::kNoRelativeMotion;
      }
      return Event::kNone;
  }
  return Event::kNone;
}

double Segmenter::trigger() const noexcept {
  const double start = settings_.start_coefficient;
  if (level_ || state_ == State::kRunning) return base() + start;
  // Only what the record will begin with may count: a replay sees no more.
  const bool was_below =
      std::any_of(waiting_.begin(), waiting_.end(), [start](double kept) { return kept < start; });
  return was_below ? start : std::max(start, UnloadedLevel::kFarthest);
}

void Segmenter::track() {
  const auto quiet = quiet_scans_.news();
  if (level_is_given_ || !quiet || !UnloadedLevel::fits(*quiet)) return;
  // A replay knows one level for all that was kept, and must not begin the test sooner by it.
  const double trigger = UnloadedLevel::of_decisions(*quiet) + settings_.start_coefficient;
  if (std::any_of(waiting_.begin(), waiting_.end(), [trigger](double kept) { return kept >= trigger; }))
    return;
  level_ = *quiet;
  above_ = 0;
}

bool Segmenter::lies_unloaded() {
  const auto quiet = quiet_scans_.news();
  if (!quiet || !UnloadedLevel::fits_after(*quiet, largest_, level_.value_or(0.0))) return false;
  level_ = *quiet;
  // What was counted before it is in no record to come.
  above_ = 0;
  return true;
}

bool Segmenter::tared(std::span<const double> kept) {
  state_ = State::kReady;
  level_ = 0.0;
  level_is_given_ = false;
  quiet_scans_.clear();
  above_ = 0;
  waiting_.assign(kept.begin(), kept.end());
  const bool was_there = was_above();
  if (was_there) waiting_.clear();
  return was_there;
}

bool Segmenter::was_above() const {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [limit = trigger()](double coefficient) { return coefficient >= limit; });
}

void Segmenter::begin() {
  state_ = State::kRunning;
  was_loaded_ = !start_now_;
  may_push_back_ = may_push_back_ || was_loaded_;
  // What the force did before the record began may not count: a replay cannot see it.
  if (std::exchange(start_now_, false)) above_ = 0;
  level_is_given_ = false;
  // As a replay: from the first scan of the record.
  quiet_scans_.clear();
  end_tail_.clear();
  level_after_.reset();
  noise_ = signal::NoiseEstimator{noise_floor(settings_)};
  despiker_ = {};
  falls_ = {};
  largest_drop_ = last_drop_ = last_period_ = last_peak_at_ = 0.0;
  fall_count_ = 0;
  smooth_ = flat_level_ = largest_ = waiting_.front();
  flat_scans_ = 0;
  for (const double coefficient : waiting_) {
    quiet_scans_.add(coefficient);
    follow(coefficient);
  }
  waiting_.clear();
}

void Segmenter::follow(double coefficient) {
  noise_.add(coefficient);
  if (!noise_.known()) return;
  const double sigma = noise_.sigma();
  const auto scan = despiker_.add(coefficient, sigma);
  if (!scan) return;
  if (const auto fall = falls_.add(scan->value, SlipRule::kHysteresisSigmas * sigma);
      fall && fall->robust_drop >= SlipRule::kSignificantSigmas * sigma) {
    ++fall_count_;
    flat_scans_ = 0;  // The smoothed force of a small oscillation is flat, too.
    last_drop_ = fall->robust_drop;
    largest_drop_ = std::max(largest_drop_, last_drop_);
    last_period_ = fall->peak_at - last_peak_at_;
    last_peak_at_ = fall->peak_at;
  }
  smooth_ += (scan->value - smooth_) / kSmoothing;
  largest_ = std::max(largest_, smooth_);
  ++flat_scans_;
  if (std::abs(smooth_ - flat_level_) > SlipRule::kHysteresisSigmas * sigma) {
    flat_level_ = smooth_;
    flat_scans_ = 0;
  }
}

bool Segmenter::belt_has_stopped() const {
  const double sigma = noise_.sigma();
  const bool full_swing = fall_count_ >= kFewestFalls && last_drop_ >= kFullSwing * largest_drop_ &&
                          last_drop_ >= kFullSwingSigmas * sigma;
  const double wanted =
      std::max(static_cast<double>(scans(settings_.no_motion_dwell_s)), kMissingPeriods * last_period_);
  return full_swing && static_cast<double>(flat_scans_) >= wanted;
}

}  // namespace stickslip::pipeline
