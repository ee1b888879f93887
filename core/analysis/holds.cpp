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
/// Part of a rise in which its line is found: below and above it is rounded.
constexpr double kRiseFrom = 0.2;
constexpr double kRiseTo = 0.8;

struct StraightLine {
  double middle_s = 0.0;
  double middle = 0.0;
  double slope_per_s = 0.0;
  double squares = 0.0;  ///< Of the residuals, over the scans.

  [[nodiscard]] double time_at(double level) const noexcept {
    return middle_s + (level - middle) / slope_per_s;
  }
  [[nodiscard]] double at(double time_s) const noexcept { return middle + slope_per_s * (time_s - middle_s); }
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
  line.squares = std::max(cc - tc * line.slope_per_s, 0.0) / n;
  return line;
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
  const auto level = line_through(trace, still, end, -HUGE_VAL, HUGE_VAL);
  if (!level || std::sqrt(level->squares) > kRestingSigmas * sigma) return std::nullopt;
  const double at_stop = level->at(trace.time_s[still]);
  const double at_go = level->at(trace.time_s[end]);
  if (std::abs(at_go - at_stop) > kCreepOfHold * height) return std::nullopt;
  Hold hold{trace.time_s[from], trace.time_s[end]};
  // A belt that stops during the slip leaves the force at its trough.
  const auto before = line_through(trace, from, still, trough + kRiseFrom * (at_stop - trough),
                                   trough + kRiseTo * (at_stop - trough));
  if (at_stop - trough > kRiseFrom * height && before && before->slope_per_s > 0.0)
    hold.stop_s = std::max(before->time_at(at_stop), trace.time_s[from]);
  const auto after = line_through(trace, end, peak, at_go + kRiseFrom * (next.peak - at_go),
                                  at_go + kRiseTo * (next.peak - at_go));
  if (after && after->slope_per_s > 0.0) {
    hold.go_s = after->time_at(at_go);
  } else {
    // So high a hold leaves no scans of the rise after it.
    hold.go_s = trace.time_s[peak] - (next.peak - at_go) / typical.height * typical.rise / scans_per_s(trace);
  }
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

base::Finding holds_finding(const std::vector<Hold>& holds, bool speed_is_known) {
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
      fmt::format("the belt stood still {}: {}", times,
                  speed_is_known ? "S and S - K are those of the slips between the holds"
                                 : "give the pull speed, without which no fit takes the holds into account"),
      {{"holds", static_cast<double>(holds.size()), "1"},
       {"shortest", shortest_s, "s"},
       {"longest", longest_s, "s"}});
}

}  // namespace stickslip::analysis
