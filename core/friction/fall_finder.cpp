#include "core/friction/fall_finder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

namespace stickslip::friction {
namespace {

double median_of_three(double a, double b, double c) noexcept {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

std::optional<Fall> FallFinder::add(double value, double hysteresis) {
  latest_.push(value);
  ++count_;
  std::optional<Fall> fall;
  // A median of one.
  if (count_ == 1) high_ = low_ = turn_ = Extreme{0, value};
  if (count_ <= 2) return fall;
  keep_scans(high_, about_high_);
  keep_scans(low_, about_low_);
  const auto scans = latest_.values().last<3>();
  const double median = median_of_three(scans[0], scans[1], scans[2]);
  step(count_ - 2, median, hysteresis, fall);
  return fall;
}

void FallFinder::step(std::size_t position, double median, double hysteresis,
                      std::optional<Fall>& fall) noexcept {
  if (direction_ == Direction::kUp) return rise(position, median, hysteresis);
  if (direction_ == Direction::kUnknown && median > high_.value) {
    restart_at_high(position, median);
  } else {
    below_.add(position, median);
    if (!(median < low_.value)) {
      above_after_low_.add(position, median);
    } else if (above_after_low_.empty()) {  // Most of a fall: as fall_to(), by the direct way.
      low_ = {position, median};
      above_.add(position, median);
    } else {
      above_after_low_.add(position, median);
      fall_to(position, median);
    }
  }

  if (direction_ == Direction::kUnknown && median < high_.value - hysteresis) {
    // The high was a maximum, and the trace may have begun at it.
    turn_ = low_.position < high_.position ? low_ : high_;
    direction_ = Direction::kDown;
    fall_to(position, median);
  } else if (median > low_.value + hysteresis) {
    if (direction_ == Direction::kDown) fall = describe(high_, low_);
    direction_ = Direction::kUp;
    turn_ = low_;
    restart_at_high(position, median);
  }
}

void FallFinder::rise(std::size_t position, double median, double hysteresis) noexcept {
  if (median > high_.value) {
    restart_at_high(position, median);
    return;
  }
  if (waiting_count_ == waiting_.size()) take_waiting(position);
  waiting_[waiting_count_++] = median;
  if (!(median < high_.value - hysteresis)) return;
  // The high was a maximum.
  take_waiting(position + 1);
  direction_ = Direction::kDown;
  fall_to(position, median);
}

void FallFinder::take_waiting(std::size_t end) noexcept {
  std::size_t position = end - waiting_count_;
  for (const double median : std::span{waiting_}.first(waiting_count_)) {
    above_after_low_.add(position, median);
    below_.add(position, median);
    ++position;
  }
  waiting_count_ = 0;
}

void FallFinder::restart_at_high(std::size_t position, double median) noexcept {
  high_ = {position, median};
  above_.clear();
  above_after_low_.clear();
  below_.clear();
  waiting_count_ = 0;
}

void FallFinder::fall_to(std::size_t position, double median) noexcept {
  low_ = {position, median};
  above_.take(above_after_low_);
}

Fall FallFinder::describe(const Extreme& peak, const Extreme& trough) const noexcept {
  Fall fall;
  std::tie(fall.peak_at, fall.peak) = interpolate(peak, about_high_, 1.0);
  std::tie(fall.trough_at, fall.trough) = interpolate(trough, about_low_, -1.0);
  const double drop = peak.value - trough.value;
  fall.robust_drop = drop;
  // 10–90 % as in rise times of instruments: ends of a fall are rounded and drown in noise.
  const std::size_t last_above = above_.find(peak.value - 0.1 * drop).value_or(peak.position);
  // Medians behind the trough are in there too, but none of them is below it: it would be the trough.
  const std::size_t first_below = below_.find(trough.value + 0.1 * drop).value_or(trough.position);
  fall.duration = first_below > last_above ? static_cast<double>(first_below - last_above) : 0.0;
  fall.rise_duration = static_cast<double>(peak.position - turn_.position);
  fall.rise_from = turn_.value;
  return fall;
}

std::pair<double, double> FallFinder::interpolate(const Extreme& extreme, const Scans& scans,
                                                  double sign) noexcept {
  // Whoever asks has seen more than kReach scans behind the extreme.
  const auto at = [&](std::size_t position) { return scans[position + kReach - extreme.position]; };
  std::size_t best = extreme.position;
  // The median of three lies at most one scan beside the true extreme scan.
  for (std::size_t position = std::max<std::size_t>(extreme.position, 1) - 1;
       position <= extreme.position + 1; ++position) {
    if (sign * at(position) > sign * at(best)) best = position;
  }
  if (best == 0) return {0.0, at(0)};
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
