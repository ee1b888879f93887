#include "core/friction/fall_finder.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace stickslip::friction {
namespace {

double median_of_three(double a, double b, double c) noexcept {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

std::optional<Fall> FallFinder::add(double value, double hysteresis) {
  scans_.push_back(value);
  ++count_;
  std::optional<Fall> fall;
  if (count_ == 1) {
    medians_.push_back(value);
    high_ = low_ = turn_ = Extreme{0, value};
    return fall;
  }
  if (count_ == 2) return fall;
  const std::size_t newest = count_ - 1;
  const double median = median_of_three(at(newest - 2), at(newest - 1), at(newest));
  medians_.push_back(median);
  step(newest - 1, median, hysteresis, fall);
  return fall;
}

void FallFinder::step(std::size_t position, double median, double hysteresis, std::optional<Fall>& fall) {
  if (direction_ != Direction::kDown && median > high_.value) high_ = {position, median};
  if (direction_ != Direction::kUp && median < low_.value) low_ = {position, median};

  if (direction_ != Direction::kDown && median < high_.value - hysteresis) {
    // The high was a maximum. While the direction is unknown the trace may have begun at it.
    if (direction_ == Direction::kUnknown) turn_ = low_.position < high_.position ? low_ : high_;
    direction_ = Direction::kDown;
    low_ = {position, median};
  } else if (direction_ != Direction::kUp && median > low_.value + hysteresis) {
    if (direction_ == Direction::kDown) fall = describe(high_, low_);
    direction_ = Direction::kUp;
    turn_ = low_;
    high_ = {position, median};
    forget_before(turn_.position);
  }
}

void FallFinder::forget_before(std::size_t position) {
  // A few scans before the turning point are kept for interpolation.
  constexpr std::size_t kKept = 4;
  if (position < base_ + kKept) return;
  const std::size_t gone = position - kKept - base_;
  const auto count = static_cast<std::ptrdiff_t>(gone);
  scans_.erase(scans_.begin(), scans_.begin() + count);
  medians_.erase(medians_.begin(), medians_.begin() + count);
  base_ += gone;
}

Fall FallFinder::describe(const Extreme& peak, const Extreme& trough) const {
  Fall fall;
  std::tie(fall.peak_at, fall.peak) = interpolate(peak, 1.0);
  std::tie(fall.trough_at, fall.trough) = interpolate(trough, -1.0);
  const double drop = peak.value - trough.value;
  fall.robust_drop = drop;
  // 10–90 % as in rise times of instruments: ends of a fall are rounded and drown in noise.
  std::size_t last_above = peak.position;
  std::size_t first_below = trough.position;
  for (std::size_t position = peak.position; position <= trough.position; ++position) {
    if (medians_[position - base_] > peak.value - 0.1 * drop) last_above = position;
  }
  for (std::size_t position = trough.position; position > peak.position; --position) {
    if (medians_[position - base_] < trough.value + 0.1 * drop) first_below = position;
  }
  fall.duration = first_below > last_above ? static_cast<double>(first_below - last_above) : 0.0;
  fall.rise_duration = static_cast<double>(peak.position - turn_.position);
  fall.rise_from = turn_.value;
  return fall;
}

std::pair<double, double> FallFinder::interpolate(const Extreme& extreme, double sign) const {
  std::size_t best = extreme.position;
  // The median of three lies at most one scan beside the true extreme scan.
  for (std::size_t position = std::max(extreme.position, base_ + 1) - 1;
       position <= extreme.position + 1 && position < count_; ++position) {
    if (sign * at(position) > sign * at(best)) best = position;
  }
  if (best == base_ || best + 1 >= count_) return {static_cast<double>(best), at(best)};
  const double left = at(best - 1);
  const double middle = at(best);
  const double right = at(best + 1);
  const double curvature = left - 2.0 * middle + right;
  if (sign * curvature >= 0.0) return {static_cast<double>(best), middle};
  const double shift = std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
  return {static_cast<double>(best) + shift, middle - 0.25 * (left - right) * shift};
}

double FallFinder::scans_since_turn() const noexcept {
  const std::size_t turn = direction_ == Direction::kDown ? high_.position : turn_.position;
  return static_cast<double>(count_ - 1 - std::min(turn, count_ - 1));
}

}  // namespace stickslip::friction
