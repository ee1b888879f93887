#include "report/plot/ranges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/contract.hpp"

namespace stickslip::plot {
namespace {

class Extent {
 public:
  explicit Extent(bool log) : log_(log) {}
  void add(double value) {
    if (!std::isfinite(value) || (log_ && !(value > 0.0))) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  /// \param room  on each side, as a part of the extent.
  [[nodiscard]] AxisRange range(double room) const {
    if (low_ > high_) return log_ ? AxisRange{0.1, 10.0} : AxisRange{0.0, 1.0};
    if (log_) {
      const double factor = low_ == high_ ? 10.0 : std::pow(high_ / low_, room);
      return {low_ / factor, high_ * factor};
    }
    if (low_ != high_) return {low_ - room * (high_ - low_), high_ + room * (high_ - low_)};
    // A constant gets an axis of its own size, or of 1.
    const double half = low_ == 0.0 ? 0.5 : std::abs(low_) / 2.0;
    return {low_ - half, high_ + half};
  }

 private:
  bool log_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

bool within(double x, const AxisRange& range) { return x >= range.from && x <= range.to; }

}  // namespace

AxisRange x_range_of(const Axis& axis, const std::vector<const Panel*>& panels) {
  if (axis.range) return *axis.range;
  Extent extent{axis.log};
  for (const Panel* panel : panels) {
    for (const Curve& curve : panel->curves) {
      for (const double x : curve.x) extent.add(x);
    }
    for (const Marker& marker : panel->markers) extent.add(marker.x);
  }
  constexpr double kRoom = 0.03;  // Half a symbol.
  return extent.range(kRoom);
}

AxisRange y_range_of(const Panel& panel, const AxisRange& x) {
  if (panel.y.range) return *panel.y.range;
  Extent extent{panel.y.log};
  for (const Curve& curve : panel.curves) {
    STICKSLIP_EXPECTS(curve.x.size() == curve.y.size());
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (within(curve.x[i], x)) extent.add(curve.y[i]);
    }
  }
  for (const Marker& marker : panel.markers) {
    if (within(marker.x, x)) extent.add(marker.y);
  }
  constexpr double kRoom = 0.06;
  return extent.range(kRoom);
}

double tick_step(const AxisRange& range, double most_steps) {
  STICKSLIP_EXPECTS(range.from < range.to && most_steps >= 1.0);
  const double least = (range.to - range.from) / most_steps;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= least) return digit * power;
  }
  return 10.0 * power;
}

}  // namespace stickslip::plot
