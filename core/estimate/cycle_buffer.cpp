#include "core/estimate/cycle_buffer.hpp"

#include <algorithm>

namespace stickslip::estimate {
namespace {

/// Number of points after a merge: leaves room, so that merging is not needed at every scan.
constexpr std::size_t kLeft = CycleBuffer::kMostPoints * 3 / 4;
/// Finest resolution tried: a block is at most 1/64 of its age long.
constexpr double kFinest = 64.0;
/// Coarsest resolution: a block is at most as long as its age. The number of points is then at most 2 log₂ of
/// the number of scans.
constexpr double kCoarsest = 1.0;

/// Means and variances of both together [Chan, Golub and LeVeque, Am. Stat. 37(3):242–247, 1983].
CyclePoint joined(const CyclePoint& a, const CyclePoint& b) noexcept {
  CyclePoint both{};
  both.count = a.count + b.count;
  const double part = b.count / both.count;
  const double apart_s = b.time_s - a.time_s;
  both.time_s = a.time_s + part * apart_s;
  both.value = a.value + part * (b.value - a.value);
  both.spread_s2 = a.spread_s2 + part * (b.spread_s2 - a.spread_s2) + part * (1.0 - part) * apart_s * apart_s;
  both.first_s = a.first_s;
  both.last_s = b.last_s;
  return both;
}

}  // namespace

void CycleBuffer::add(const CyclePoint& point) noexcept {
  if (size_ == kMostPoints) compact();
  points_[size_++] = point;
}

void CycleBuffer::keep_fine(double from_s, double to_s, double longest_s) noexcept {
  fine_from_s_ = from_s;
  fine_to_s_ = to_s;
  fine_longest_s_ = longest_s;
}

void CycleBuffer::forget_before(double time_s) noexcept {
  const auto end = points_.begin() + static_cast<std::ptrdiff_t>(size_);
  const auto kept = std::partition_point(points_.begin(), end,
                                         [&](const CyclePoint& point) { return point.last_s < time_s; });
  size_ = static_cast<std::size_t>(std::move(kept, end, points_.begin()) - points_.begin());
}

std::span<const CyclePoint> CycleBuffer::since(double time_s) const noexcept {
  const std::span<const CyclePoint> all = points();
  const auto first = std::partition_point(all.begin(), all.end(),
                                          [&](const CyclePoint& point) { return point.first_s < time_s; });
  return all.subspan(static_cast<std::size_t>(first - all.begin()));
}

std::span<const CyclePoint> between(std::span<const CyclePoint> points, double from_s, double to_s) noexcept {
  const auto rises = [](const CyclePoint& point, double time_s) { return point.time_s < time_s; };
  const auto first = std::lower_bound(points.begin(), points.end(), from_s, rises);
  const auto end = std::lower_bound(first, points.end(), to_s, rises);
  return points.subspan(static_cast<std::size_t>(first - points.begin()),
                        static_cast<std::size_t>(end - first));
}

bool CycleBuffer::may_merge(const CyclePoint& before, const CyclePoint& after,
                            double resolution) const noexcept {
  const double length_s = after.last_s - before.first_s;
  const double age_s = points_[size_ - 1].last_s - after.last_s;
  if (length_s * resolution > age_s) return false;
  const bool fine = after.last_s > fine_from_s_ && before.first_s < fine_to_s_;
  return !fine || length_s <= fine_longest_s_;
}

std::size_t CycleBuffer::merged_count(double resolution) const noexcept {
  std::size_t count = 0;
  CyclePoint last{};
  for (std::size_t i = 0; i < size_; ++i) {
    if (i > 0 && may_merge(last, points_[i], resolution)) {
      last.last_s = points_[i].last_s;
    } else {
      last = points_[i];
      ++count;
    }
  }
  return count;
}

void CycleBuffer::merge(double resolution) noexcept {
  // The newest point, which may_merge() looks at, is never joined and moves last.
  std::size_t last = 0;
  for (std::size_t i = 1; i < size_; ++i) {
    if (may_merge(points_[last], points_[i], resolution)) {
      points_[last] = joined(points_[last], points_[i]);
    } else {
      points_[++last] = points_[i];
    }
  }
  size_ = last + 1;
}

void CycleBuffer::compact() noexcept {
  double resolution = kFinest;
  while (resolution >= kCoarsest && merged_count(resolution) > kLeft) resolution *= 0.5;
  if (resolution < kCoarsest) {  // Too much of it was to be fine.
    fine_to_s_ = fine_from_s_;
    resolution = kCoarsest;
  }
  merge(resolution);
  // Times that do not rise cannot be merged by age; whatever comes, there is room.
  if (size_ == kMostPoints) {
    std::move(points_.begin() + (kMostPoints - kLeft), points_.end(), points_.begin());
    size_ = kLeft;
  }
}

void read_slip(CycleBuffer& buffer, const Trace& trace, std::size_t first, std::size_t end, double period_s) {
  constexpr double kBlocksPerPeriod = 40.0;
  const double first_s = trace.time_s[first];
  buffer.clear();
  buffer.keep_fine(first_s, first_s + period_s, period_s / kBlocksPerPeriod);
  for (std::size_t k = first; k < end; ++k) {
    if (trace.usable[k] != 0) buffer.add(trace.time_s[k], trace.level(k));
  }
}

}  // namespace stickslip::estimate
