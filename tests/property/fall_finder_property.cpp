/// What FallFinder remembers in bounded memory is what it would find if it kept every scan.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "core/detect/fall_finder.hpp"
#include "core/signal/level_positions.hpp"

namespace stickslip::detect {
namespace {

/// The definition of turning points and falls in fall_finder.hpp with everything kept and searched anew.
class PlainFinder {
 public:
  std::optional<Fall> add(double value, double hysteresis) {
    scans_.push_back(value);
    if (scans_.size() == 1) {
      medians_.push_back(value);
      return {};
    }
    if (scans_.size() == 2) return {};
    std::vector<double> three(scans_.end() - 3, scans_.end());
    std::sort(three.begin(), three.end());
    medians_.push_back(three[1]);
    const std::size_t now = medians_.size() - 1;
    const double median = medians_[now];
    std::optional<Fall> fall;
    if (direction_ >= 0 && median > medians_[high_]) high_ = now;
    if (direction_ <= 0 && median < medians_[low_]) low_ = now;
    if (direction_ >= 0 && median < medians_[high_] - hysteresis) {
      if (direction_ == 0) turn_ = std::min(low_, high_);
      direction_ = -1;
      low_ = now;
    } else if (direction_ <= 0 && median > medians_[low_] + hysteresis) {
      if (direction_ < 0) fall = describe();
      direction_ = 1;
      turn_ = low_;
      high_ = now;
    }
    return fall;
  }

  [[nodiscard]] double scans_since_turn() const {
    return static_cast<double>(scans_.size() - 1 - (direction_ < 0 ? high_ : turn_));
  }

 private:
  [[nodiscard]] Fall describe() const {
    Fall fall;
    std::tie(fall.peak_at, fall.peak) = refine(high_, 1.0);
    std::tie(fall.trough_at, fall.trough) = refine(low_, -1.0);
    fall.robust_drop = medians_[high_] - medians_[low_];
    std::size_t last_above = high_;
    std::size_t first_below = low_;
    for (std::size_t k = high_; k <= low_; ++k) {
      if (medians_[k] > medians_[high_] - 0.1 * fall.robust_drop) last_above = k;
    }
    for (std::size_t k = low_; k > high_; --k) {
      if (medians_[k] < medians_[low_] + 0.1 * fall.robust_drop) first_below = k;
    }
    fall.duration = first_below > last_above ? static_cast<double>(first_below - last_above) : 0.0;
    fall.rise_duration = static_cast<double>(high_ - turn_);
    fall.rise_from = medians_[turn_];
    return fall;
  }

  [[nodiscard]] std::pair<double, double> refine(std::size_t extreme, double sign) const {
    std::size_t best = extreme;
    for (std::size_t k = extreme - std::min<std::size_t>(extreme, 1); k <= extreme + 1; ++k) {
      if (sign * scans_[k] > sign * scans_[best]) best = k;
    }
    const auto at = static_cast<double>(best);
    if (best == 0) return {at, scans_[0]};
    const double left = scans_[best - 1];
    const double right = scans_[best + 1];
    const double curvature = left - 2.0 * scans_[best] + right;
    if (sign * curvature >= 0.0) return {at, scans_[best]};
    const double shift = std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
    return {at + shift, scans_[best] - 0.25 * (left - right) * shift};
  }

  std::vector<double> scans_;
  std::vector<double> medians_;
  int direction_ = 0;
  std::size_t high_ = 0;
  std::size_t low_ = 0;
  std::size_t turn_ = 0;
};

struct Input {
  std::vector<double> values;
  std::vector<double> hysteresis;  ///< Of each scan.
};

using Engine = std::mt19937_64;

std::vector<double> walk(Engine& engine, std::size_t count) {
  std::normal_distribution<double> step{0.0, 0.4};
  std::vector<double> values(count);
  double at = 0.0;
  for (double& value : values) value = at += step(engine);
  return values;
}

std::vector<double> noise(Engine& engine, std::size_t count) {
  std::normal_distribution<double> normal{0.3, 1.0};
  std::vector<double> values(count);
  for (double& value : values) value = normal(engine);
  return values;
}

/// Sticks and slips of random lengths and heights, with noise or without.
std::vector<double> stick_slip(Engine& engine, std::size_t count) {
  std::uniform_int_distribution<int> length{1, 120};
  std::uniform_real_distribution<double> level{0.0, 30.0};
  std::normal_distribution<double> scan{0.0,
                                        std::uniform_int_distribution<int>{0, 1}(engine) == 0 ? 0.0 : 0.7};
  std::vector<double> values;
  double from = 0.0;
  for (bool up = true; values.size() < count; up = !up) {
    const double to = level(engine) + (up ? 10.0 : -10.0);
    const int scans = length(engine);
    for (int k = 0; k < scans && values.size() < count; ++k) {
      // Half a cosine: rounded ends, as slips have them.
      const double part = 0.5 - 0.5 * std::cos(std::numbers::pi * k / scans);
      values.push_back(from + (to - from) * part + scan(engine));
    }
    from = to;
  }
  return values;
}

std::vector<double> flat(Engine& engine, std::size_t count) {
  std::bernoulli_distribution step{0.02};
  std::vector<double> values(count, 0.25);
  for (double& value : values) value += step(engine) ? 1.0 : 0.0;
  return values;
}

/// All kinds of course, also in a few steps of a converter, so that many values are equal; a hysteresis as
/// the live one: infinite until the noise is known, then moving.
Input any_input(std::size_t longest) {
  Engine engine{*rc::gen::arbitrary<std::uint64_t>()};
  const auto count = *rc::gen::inRange<std::size_t>(1, longest);
  Input input;
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      input.values = walk(engine, count);
      break;
    case 1:
      input.values = noise(engine, count);
      break;
    case 2:
      input.values = stick_slip(engine, count);
      break;
    default:
      input.values = flat(engine, count);
  }
  if (*rc::gen::inRange(0, 2) == 0) {
    // + 0: a median of 0 and −0 may be either.
    for (double& value : input.values) value = std::round(value) + 0.0;
  }
  const double typical = *rc::gen::element(0.4, 1.0, 3.0, 6.0);
  input.hysteresis.assign(count, typical);
  if (*rc::gen::inRange(0, 2) == 0) {
    std::uniform_real_distribution<double> factor{0.5, 2.0};
    for (double& hysteresis : input.hysteresis) hysteresis *= factor(engine);
    const std::size_t unknown = std::min<std::size_t>(count, *rc::gen::inRange<std::size_t>(0, 300));
    std::fill_n(input.hysteresis.begin(), unknown, std::numeric_limits<double>::infinity());
  }
  return input;
}

RC_GTEST_PROP(FallFinderProperty, FindsWhatASearchThroughAllScansFinds, ()) {
  const Input input = any_input(signal::kMostSteps);
  FallFinder finder;
  PlainFinder plain;
  int falls = 0;
  for (std::size_t k = 0; k < input.values.size(); ++k) {
    const auto found = finder.add(input.values[k], input.hysteresis[k]);
    const auto expected = plain.add(input.values[k], input.hysteresis[k]);
    RC_ASSERT(found.has_value() == expected.has_value());
    RC_ASSERT(finder.scans_since_turn() == plain.scans_since_turn());
    if (!found) continue;
    ++falls;
    using Bits = std::array<std::uint64_t, 8>;
    RC_ASSERT(std::bit_cast<Bits>(*found) == std::bit_cast<Bits>(*expected));
  }
  RC_TAG(falls == 0 ? "no fall" : falls < 5 ? "1 to 4 falls" : "5 falls or more");
}

/// A long fall: noise on a line, or a line with stages in which nothing moves.
std::vector<double> long_fall(Engine& engine, std::size_t length) {
  const double noise_sd = std::uniform_int_distribution<int>{0, 1}(engine) == 0 ? 0.0 : 1.0;
  std::normal_distribution<double> normal{0.0, 1.0};
  std::uniform_real_distribution<double> slope{0.0, 0.1};
  std::uniform_int_distribution<std::size_t> stage{1, length};
  std::vector<double> values;
  double level = 0.0;
  while (values.size() < length) {
    const double step = std::bernoulli_distribution{0.3}(engine) ? 0.0 : slope(engine);
    for (std::size_t left = stage(engine); left > 0 && values.size() < length; --left) {
      values.push_back((level -= step) + noise_sd * normal(engine));
    }
  }
  for (int k = 0; k < 400; ++k) values.push_back(level + 0.5 * k);
  return values;
}

RC_GTEST_PROP(FallFinderProperty, DurationOfALongFallIsKnownToAPartOfIt, ()) {
  Engine engine{*rc::gen::arbitrary<std::uint64_t>()};
  const auto length = *rc::gen::inRange<std::size_t>(1, 30 * signal::kMostSteps);
  FallFinder finder;
  PlainFinder plain;
  for (const double value : long_fall(engine, length)) {
    const auto found = finder.add(value, 6.0);
    const auto expected = plain.add(value, 6.0);
    RC_ASSERT(found.has_value() == expected.has_value());
    if (!found) continue;
    RC_ASSERT(found->peak_at == expected->peak_at);
    RC_ASSERT(found->trough_at == expected->trough_at);
    RC_ASSERT(found->robust_drop == expected->robust_drop);
    // Two positions, each off by less than 2/(kMostSteps − 2) of the time from peak to trough (Stairs).
    const double span = expected->trough_at - expected->peak_at + 2.0;
    const double bound = span > static_cast<double>(signal::kMostSteps)
                             ? 4.0 * span / static_cast<double>(signal::kMostSteps - 2)
                             : 0.0;
    RC_ASSERT(found->duration >= expected->duration);
    RC_ASSERT(found->duration - expected->duration <= bound);
  }
}

}  // namespace
}  // namespace stickslip::detect
