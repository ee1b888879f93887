#include "report/plot/thinning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/contract.hpp"

namespace stickslip::plot {
namespace {

bool drawable(double value, bool log) { return std::isfinite(value) && (!log || value > 0.0); }

std::vector<Polyline> pieces_within(const Curve& curve, const AxisRange& range, bool log_x, bool log_y) {
  std::vector<Polyline> pieces;
  bool open = false;
  const std::size_t count = curve.x.size();
  const auto side = [&](std::size_t i) {
    return curve.x[i] < range.from ? -1 : curve.x[i] > range.to ? 1 : 0;
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (!drawable(curve.x[i], log_x) || !drawable(curve.y[i], log_y)) {
      open = false;
      continue;
    }
    // Outside, a point counts only if the line from or to it crosses the range.
    const int here = side(i);
    const bool from_before = i > 0 && side(i - 1) != here;
    const bool to_next = i + 1 < count && side(i + 1) != here;
    if (here != 0 && !from_before && !to_next) {
      open = false;
      continue;
    }
    if (!open) pieces.emplace_back();
    open = true;
    pieces.back().x.push_back(curve.x[i]);
    pieces.back().y.push_back(curve.y[i]);
  }
  return pieces;
}

Polyline thinned(const Polyline& piece, const AxisRange& range, bool log_x, std::size_t columns) {
  const auto column_of = [&](double x) {
    const double part = log_x ? std::log(x / range.from) / std::log(range.to / range.from)
                              : (x - range.from) / (range.to - range.from);
    return std::floor(part * static_cast<double>(columns));
  };
  Polyline kept;
  const auto keep = [&](std::size_t i) {
    kept.x.push_back(piece.x[i]);
    kept.y.push_back(piece.y[i]);
  };
  const std::size_t count = piece.x.size();
  keep(0);
  for (std::size_t first = 1; first + 1 < count;) {
    const double column = column_of(piece.x[first]);
    std::size_t low = first;
    std::size_t high = first;
    std::size_t i = first;
    for (; i + 1 < count && column_of(piece.x[i]) == column; ++i) {
      if (piece.y[i] < piece.y[low]) low = i;
      if (piece.y[i] > piece.y[high]) high = i;
    }
    keep(std::min(low, high));
    if (low != high) keep(std::max(low, high));
    first = i;
  }
  if (count > 1) keep(count - 1);
  return kept;
}

}  // namespace

std::vector<Polyline> visible_pieces(const Curve& curve, const AxisRange& range, bool log_x, bool log_y,
                                     std::size_t columns) {
  STICKSLIP_EXPECTS(curve.x.size() == curve.y.size());
  STICKSLIP_EXPECTS(range.from < range.to && columns > 0);
  std::vector<Polyline> pieces = pieces_within(curve, range, log_x, log_y);
  std::size_t points = 0;
  for (const Polyline& piece : pieces) points += piece.x.size();
  if (points > 2 * columns) {
    for (Polyline& piece : pieces) piece = thinned(piece, range, log_x, columns);
  }
  return pieces;
}

}  // namespace stickslip::plot
