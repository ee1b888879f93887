#include "core/analysis/holds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/analysis/slip_guess.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Rises from a trough to the next peak of which the median is that without a hold.
constexpr std::size_t kFewestRises = 4;
/// Length of a rise with a hold over that of one without.
constexpr double kLongRise = 3.0;
/// Fewest scans of which it is known that the belt stands still, whatever the moment of its stop.
constexpr std::size_t kFewestStill = 8;
/// A contact at rest creeps: part of the rise by which the force may change during a hold.
constexpr double kCreepOfHold = 0.25;
/// Scatter of a force at rest over the noise of a scan: a sled that slides on paper is rougher.
constexpr double kRestingSigmas = 2.0;
/// Part of a rise at either end in which its line is not looked for: there it is rounded.
constexpr double kRiseFrom = 0.2;
/// Nor so near to a level that stands still, over the noise of a scan.
constexpr double kClearSigmas = 3.0;

struct StraightLine {
  double middle_s = 0.0;
  double middle = 0.0;
  double slope_per_s = 0.0;
  double variance = 0.0;  ///< Of the residuals.

  [[nodiscard]] double time_at(double level) const noexcept {
    return middle_s + (level - middle) / slope_per_s;
  }
};

/// Through the usable scans of [first, end) whose values lie within [low, high].
std::optional<StraightLine> line_through(const estimate::Trace& trace, std::size_t first, std::size_t end,
                                         double low, double high) {
  double n = 0.0;
  StraightLine line;
  double tt = 0.0;
  double tc = 0.0;
  double cc = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    const double c = trace.value[k];
    if (trace.usable[k] == 0 || c < low || c > high) continue;
    n += 1.0;
    const double t_off = trace.time_s[k] - line.middle_s;
    const double c_off = c - line.middle;
    line.middle_s += t_off / n;
    line.middle += c_off / n;
    tt += t_off * (trace.time_s[k] - line.middle_s);
    tc += t_off * (c - line.middle);
    cc += c_off * (c - line.middle);
  }
  if (n < 3.0 || !(tt > 0.0)) return std::nullopt;
  line.slope_per_s = tc / tt;
  line.variance = std::max(cc - tc * line.slope_per_s, 0.0) / n;
  return line;
}

/// Median of the usable scans from first to last; nothing if there are none.
std::optional<double> level_about(const estimate::Trace& trace, std::size_t first, std::size_t last) {
  std::vector<double> levels;
  for (std::size_t k = first; k <= last; ++k) {
    if (trace.usable[k] != 0) levels.push_back(trace.value[k]);
  }
  return levels.empty() ? std::nullopt : std::optional{signal::median(levels)};
}

/// Whether the force rests in [first, end): by the second differences of neighbours, whatever it does slowly,
/// and by a straight line through the second half, since a contact at rest creeps fast at first only.
bool rests(const estimate::Trace& trace, std::size_t first, std::size_t end, double sigma) {
  constexpr double kOfNoise = 6.0;  // Variance of c₋ − 2c + c₊ over that of c.
  signal::RunningMean squares;
  for (std::size_t k = first + 1; k + 1 < end; ++k) {
    if (trace.usable[k - 1] == 0 || trace.usable[k] == 0 || trace.usable[k + 1] == 0) continue;
    const double bend = trace.value[k - 1] - 2.0 * trace.value[k] + trace.value[k + 1];
    squares.add(bend * bend / kOfNoise);
  }
  const auto half = line_through(trace, first + (end - first) / 2, end, -HUGE_VAL, HUGE_VAL);
  const double most = kRestingSigmas * sigma;
  return squares.count > 0.0 && half && std::max(squares.mean, half->variance) <= most * most;
}

/// Medians over the slips, or over a thousand of them.
struct Typical {
  double fall = 0.0;    ///< Scans from a peak to its trough.
  double rise = 0.0;    ///< Scans from there to the next peak.
  double height = 0.0;  ///< Of that rise.
};

std::optional<Typical> typical_of(const base::LongColumn<detect::Fall>& slips) {
  constexpr std::size_t kEnough = 1000;
  if (slips.size() <= kFewestRises) return std::nullopt;
  std::vector<double> falls;
  std::vector<double> rises;
  std::vector<double> heights;
  const std::size_t step = std::max<std::size_t>(slips.size() / kEnough, 1);
  for (std::size_t i = 1; i < slips.size(); i += step) {
    const detect::Fall before = slips[i - 1];
    const detect::Fall after = slips[i];
    falls.push_back(before.trough_at - before.peak_at);
    rises.push_back(after.peak_at - before.trough_at);
    heights.push_back(after.peak - before.trough);
  }
  return Typical{signal::median(falls), signal::median(rises), signal::median(heights)};
}

/// Where the line of a rise meets a level; nothing if it has no line of about the usual slope.
std::optional<double> meets_s(const std::optional<StraightLine>& rise, double level, double slope_per_s) {
  constexpr double kUsual = 2.0;
  if (!rise || rise->slope_per_s < slope_per_s / kUsual || rise->slope_per_s > slope_per_s * kUsual)
    return std::nullopt;
  return rise->time_at(level);
}

/// The rise from scan `from` to the peak of `next`, if the belt stood still in it.
std::optional<Hold> hold_between(const estimate::Trace& trace, std::size_t from, const detect::Fall& next,
                                 double trough, const Typical& typical, double sigma) {
  const std::size_t peak = scan_at(next.peak_at);
  const double height = next.peak - trough;
  // Both rises together take as long as one without a hold: this far from either end the force stands still.
  const auto rising =
      static_cast<std::size_t>(std::ceil(typical.rise * std::max(height / typical.height, 1.0)));
  if (peak < from || static_cast<double>(peak - from) < kLongRise * static_cast<double>(rising))
    return std::nullopt;
  const std::size_t still = from + rising;
  const std::size_t end = peak - rising;
  if (end < still + kFewestStill || estimate::is_broken(trace, static_cast<double>(from), next.peak_at))
    return std::nullopt;
  const auto at_stop = level_about(trace, still, still + (end - still) / 8);
  const auto at_go = level_about(trace, end - (end - still) / 8, end);
  if (!at_stop || !at_go || std::abs(*at_go - *at_stop) > kCreepOfHold * height ||
      !rests(trace, still, end, sigma))
    return std::nullopt;
  const double slope_per_s = typical.height / typical.rise * scans_per_s(trace);
  const auto rise_between = [&](std::size_t first, std::size_t last, double low, double high) {
    const double margin = std::max(kRiseFrom * (high - low), kClearSigmas * sigma);
    return line_through(trace, first, last, low + margin, high - margin);
  };
  // A belt that stops during the slip leaves the force at its trough.
  Hold hold{trace.time_s[from], trace.time_s[peak] - (next.peak - *at_go) / slope_per_s};
  if (const auto stop_s = meets_s(rise_between(from, still, trough, *at_stop), *at_stop, slope_per_s))
    hold.stop_s = std::clamp(*stop_s, trace.time_s[from], trace.time_s[still]);
  if (const auto go_s = meets_s(rise_between(end, peak, *at_go, next.peak), *at_go, slope_per_s))
    hold.go_s = std::clamp(*go_s, trace.time_s[end], trace.time_s[peak]);
  return hold.stop_s < hold.go_s ? std::optional{hold} : std::nullopt;
}

}  // namespace

std::vector<Hold> find_holds(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                             double sigma) {
  const std::optional<Typical> typical = typical_of(slips);
  std::vector<Hold> holds;
  if (!typical) return holds;
  for (std::size_t i = 1; i < slips.size(); ++i) {
    const detect::Fall before = slips[i - 1];
    // In a hold the lowest scan may lie anywhere.
    const double trough_at = std::min(before.trough_at, before.peak_at + typical->fall);
    const auto hold = hold_between(trace, scan_at(trough_at), slips[i], before.trough, *typical, sigma);
    if (hold) holds.push_back(*hold);
  }
  return holds;
}

std::optional<model::PullSpeed> course_with_holds(double pull_speed_m_per_s, double begin_s,
                                                  const std::vector<Hold>& holds) {
  std::vector<model::SpeedPoint> points{{0.0, pull_speed_m_per_s}};
  for (const Hold& hold : holds) {
    points.push_back({hold.stop_s - begin_s, pull_speed_m_per_s});
    points.push_back({hold.stop_s - begin_s, 0.0});
    points.push_back({hold.go_s - begin_s, 0.0});
    points.push_back({hold.go_s - begin_s, pull_speed_m_per_s});
  }
  return model::PullSpeed::make(std::move(points));
}

base::Finding holds_finding(const std::vector<Hold>& holds, bool left_out, bool speed_is_known) {
  double shortest_s = holds.front().go_s - holds.front().stop_s;
  double longest_s = shortest_s;
  for (const Hold& hold : holds) {
    shortest_s = std::min(shortest_s, hold.go_s - hold.stop_s);
    longest_s = std::max(longest_s, hold.go_s - hold.stop_s);
  }
  const std::string times = holds.size() == 1 ? fmt::format("once, for {:.3g} s", longest_s)
                                              : fmt::format("{} times, for {:.3g} to {:.3g} s", holds.size(),
                                                            shortest_s, longest_s);
  return base::make_finding(
      base::FindingCode::kHolds,
      fmt::format("the belt stood still {}{}", times,
                  left_out ? ": S and S - K are those of the slips between the holds"
                  : speed_is_known
                      ? ""
                      : ": give the pull speed, without which nothing takes the holds into account"),
      {{"holds", static_cast<double>(holds.size()), "1"},
       {"shortest", shortest_s, "s"},
       {"longest", longest_s, "s"}});
}

}  // namespace stickslip::analysis
