#include "core/analysis/measured_speed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

namespace stickslip::analysis {
namespace {

/// Standard deviations of a reading's noise: four for the reading, which one in 16 000 exceeds, and two for
/// the point at which the line begins.
constexpr double kSigmas = 6.0;

}  // namespace

double MeasuredSpeed::resolution(double noise_m_per_s, double step_m_per_s) noexcept {
  return kSigmas * std::max(noise_m_per_s, step_m_per_s / (2.0 * std::numbers::sqrt3));
}

void MeasuredSpeed::begin_line() {
  line_ = {};
  least_m_per_s2_ = -std::numeric_limits<double>::infinity();
  most_m_per_s2_ = std::numeric_limits<double>::infinity();
}

void MeasuredSpeed::end_line() {
  Knot& left = knots_.back();
  // Weights 1 − x/L and x/L of the line's ends in each reading.
  const double length_s = latest_s_ - left.time_s;
  const double x = line_.x / length_s;
  const double xx = line_.xx / (length_s * length_s);
  const double xv = line_.xv / length_s;
  left.own += line_.n - 2.0 * x + xx;
  left.right = x - xx;
  left.sum += line_.v - xv;
  anchor_m_per_s_ += 0.5 * (least_m_per_s2_ + most_m_per_s2_) * length_s;
  knots_.push_back({latest_s_, xx, 0.0, xv});
  begin_line();
}

void MeasuredSpeed::add(double time_s, double speed_m_per_s) {
  if (knots_.empty()) {
    knots_.push_back({time_s, 1.0, 0.0, speed_m_per_s});
    anchor_m_per_s_ = speed_m_per_s;
    latest_s_ = time_s;
    begin_line();
    return;
  }
  const auto slopes = [&] {
    const double since_s = time_s - knots_.back().time_s;
    return std::pair{(speed_m_per_s - resolution_m_per_s_ - anchor_m_per_s_) / since_s,
                     (speed_m_per_s + resolution_m_per_s_ - anchor_m_per_s_) / since_s};
  };
  auto [least, most] = slopes();
  if (std::max(least, least_m_per_s2_) > std::min(most, most_m_per_s2_)) {
    end_line();
    std::tie(least, most) = slopes();
  }
  least_m_per_s2_ = std::max(least, least_m_per_s2_);
  most_m_per_s2_ = std::min(most, most_m_per_s2_);
  const double x = time_s - knots_.back().time_s;
  line_.n += 1.0;
  line_.x += x;
  line_.xx += x * x;
  line_.v += speed_m_per_s;
  line_.xv += x * speed_m_per_s;
  latest_s_ = time_s;
}

std::optional<model::PullSpeed> MeasuredSpeed::course() {
  if (knots_.empty()) return std::nullopt;
  if (line_.n > 0.0) end_line();
  // Elimination without pivots: each knot has a reading of its own, so the matrix is positive definite.
  std::vector<Knot> rows = knots_;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double factor = rows[i - 1].right / rows[i - 1].own;
    rows[i].own -= factor * rows[i - 1].right;
    rows[i].sum -= factor * rows[i - 1].sum;
  }
  std::vector<model::SpeedPoint> points(rows.size());
  for (std::size_t i = rows.size(); i-- > 0;) {
    const double next = i + 1 < rows.size() ? rows[i].right * points[i + 1].speed_m_per_s : 0.0;
    points[i] = {rows[i].time_s, (rows[i].sum - next) / rows[i].own};
  }
  for (model::SpeedPoint& point : points) {
    if (std::abs(point.speed_m_per_s) <= resolution_m_per_s_) point.speed_m_per_s = 0.0;
  }
  return model::PullSpeed::make(std::move(points));
}

}  // namespace stickslip::analysis
