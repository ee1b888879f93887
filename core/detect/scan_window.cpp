#include "core/detect/scan_window.hpp"

#include <algorithm>
#include <cstdint>
#include <numbers>

namespace stickslip::detect {
namespace {

/// Rows a period. The mean over a row then differs from its second-order approximation by less than 10⁻⁵ of
/// the amplitude. The borders are fixed in time, so that rows can be reused at the next evaluation.
constexpr double kRowsPerPeriod = 40.0;
/// Limits of outliers: one in kRowsPerStray rows, and kMostStrays in all. With more, neither trajectory
/// describes the scans.
constexpr std::size_t kRowsPerStray = 5;
constexpr std::size_t kMostStrays = 3;
/// Parameters of a free oscillation; more rows than this must remain, since it fits as many exactly.
constexpr std::size_t kFreeParameters = 3;

}  // namespace

ScanRow ScanWindow::row_of(std::span<const estimate::CyclePoint> together, double first_s,
                           const model::SharedParameters& shared) noexcept {
  const auto& [omega, gamma, r] = shared;
  ScanRow row{};
  double count = 0.0;
  double squares = 0.0;  // Of times, for the spread of all scans together.
  for (const estimate::CyclePoint& point : together) {
    const double tau_s = point.time_s - first_s;
    const double decay = std::exp(-0.5 * gamma * tau_s);
    const double cosine = decay * std::cos(omega * tau_s);
    const double sine = decay * std::sin(omega * tau_s) / omega;
    double by_D = cosine + 0.5 * gamma * sine;
    double by_rate = sine;
    if (point.spread_s2 > 0.0) {
      // Both solve f″ = −γ f′ − ω₀² f; the first has f′ = −ω₀² sine, the second cosine − γ/2 sine.
      const double omega0_squared = omega * omega + 0.25 * gamma * gamma;
      const double half_s2 = 0.5 * point.spread_s2;
      by_D += half_s2 * omega0_squared * (gamma * sine - by_D);
      by_rate -= half_s2 * (gamma * (cosine - 0.5 * gamma * sine) + omega0_squared * sine);
    }
    row.tau_s += point.count * tau_s;
    row.value += point.count * point.value;
    row.by_D += point.count * by_D;
    row.by_rate += point.count * by_rate;
    squares += point.count * (tau_s * tau_s + point.spread_s2);
    count += point.count;
  }
  const double part = 1.0 / count;
  row.tau_s *= part;
  row.value *= part;
  row.by_D *= part;
  row.by_rate *= part;
  row.root_count = std::sqrt(count);
  row.half_spread_s2 = 0.5 * std::max(squares * part - row.tau_s * row.tau_s, 0.0);
  row.begin_s = together.front().time_s;
  row.end_s = together.back().time_s;
  return row;
}

std::size_t ScanWindow::lay_out(std::span<const estimate::CyclePoint> points,
                                const model::SharedParameters& shared, double sigma) noexcept {
  const double first_s = points.front().time_s;
  const bool same_trajectories =
      first_s == first_s_ && shared.omega == shared_.omega && shared.gamma == shared_.gamma;
  const double rows_per_s = kRowsPerPeriod * shared.omega / (2.0 * std::numbers::pi);
  const auto place = [&](const estimate::CyclePoint& point) {
    return static_cast<std::int64_t>((point.time_s - first_s) * rows_per_s);
  };
  // Points only come at the end, and are joined: while the last row begins at the point where it began, no
  // point before was joined, and no row before it is another. It itself may have got more of them.
  const bool grown = same_trajectories && size_ > 0 && back().first_point < points.size() &&
                     points[back().first_point].time_s == back().begin_s;
  const std::size_t last = size_ - 1;
  std::size_t kept = grown ? last : 0;
  std::size_t begin = grown ? back().first_point : 0;
  for (size_ = kept; begin < points.size(); ++size_) {
    const auto here = place(points[begin]);
    std::size_t end = begin + 1;
    while (end < points.size() && place(points[end]) == here) ++end;
    ScanRow& row = rows_[size_];
    if (grown && size_ == last && points[end - 1].time_s == row.end_s) {
      ++kept;
    } else {
      row = row_of(points.subspan(begin, end - begin), first_s, shared);
      row.first_point = begin;
      row.scale = row.root_count / sigma;
    }
    begin = end;
  }
  if (sigma != sigma_) {
    sigma_ = sigma;
    readmit(0, size_);
    kept = 0;
  }
  first_s_ = first_s;
  shared_ = shared;
  return kept;
}

void ScanWindow::readmit(std::size_t from, std::size_t to) noexcept {
  for (ScanRow& row : std::span{rows_}.subspan(from, to - from)) {
    row.stray = false;
    row.scale = row.root_count / sigma_;
  }
}

bool ScanWindow::leave_out(std::size_t which, std::size_t count, std::size_t from, std::size_t to) noexcept {
  const auto strays = [](std::span<const ScanRow> rows) {
    return static_cast<std::size_t>(std::ranges::count_if(rows, &ScanRow::stray));
  };
  const std::size_t left_out = 1 + strays(all());
  if (left_out > kMostStrays || kRowsPerStray * (left_out - 1 + count) > size_) return false;
  const std::size_t left = to - from - strays(all().subspan(from, to - from)) - 1;
  if (left <= kFreeParameters) return false;
  rows_[which].stray = true;
  rows_[which].scale = 0.0;
  return true;
}

}  // namespace stickslip::detect
