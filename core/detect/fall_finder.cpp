#include "core/detect/fall_finder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

namespace stickslip::detect {
void FallFinder::take_waiting(std::size_t end) noexcept {
  std::size_t position = end - waiting_count_;
  for (const double median : std::span{waiting_}.first(waiting_count_)) {
    above_after_low_.add(position, median);
    below_.add(position, median);
    ++position;
  }
  waiting_count_ = 0;
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

}  // namespace stickslip::detect
