#include "core/detect/rise.hpp"

#include <algorithm>

#include "core/detect/turning_points.hpp"

namespace stickslip::detect {
namespace {

/// Range of a rise, as fractions of its height, in which its slope is the stick rate. With fewer than kFewest
/// points there, as in a fast loading, the wider range is used, so that one outlier has less effect.
constexpr double kFrom = 0.3;
constexpr double kTo = 0.7;
constexpr double kFastFrom = 0.1;
constexpr double kFastTo = 0.8;
constexpr std::ptrdiff_t kFewest = 8;

}  // namespace

double Rise::line_from_s(std::span<const estimate::CyclePoint> points, double from_s) const noexcept {
  const double level = from + kFrom * (peak - from);
  bool is_low = false;
  for (const estimate::CyclePoint& point : estimate::between(points, from_s, peak_s)) {
    if (is_low) from_s = point.first_s;
    is_low = point.value < level;
  }
  return is_low ? peak_s : from_s;
}

double Rise::slope(std::span<const estimate::CyclePoint> points, double from_s, double sigma) const noexcept {
  const auto before = estimate::between(points, std::max(from_s, begin_s), peak_s);
  const auto level = [&](double part) { return from + part * (peak - from); };
  const bool few = std::ranges::count_if(before, [&](const estimate::CyclePoint& point) {
                     return point.value >= level(kFrom) && point.value <= level(kTo);
                   }) < kFewest;
  const double of_points =
      slope_between(before, level(few ? kFastFrom : kFrom), level(few ? kFastTo : kTo), sigma).value_or(0.0);
  return of_points > 0.0 ? of_points : (peak - from) / (peak_s - begin_s);
}

}  // namespace stickslip::detect
