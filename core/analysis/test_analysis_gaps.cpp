// What gaps and the speed of the pull make of the trace of a test.
#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "core/analysis/belt_start.hpp"
#include "core/analysis/holds.hpp"
#include "core/analysis/measured_speed.hpp"
#include "core/analysis/test_analysis.hpp"
#include "core/signal/noise.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Forgets the falls outside the pulls of the belt: one that begins as the belt stops or turns is no slip.
void keep_pulled(const estimate::Trace& trace, base::LongColumn<detect::Fall>& slips,
                 const std::filesystem::path& scratch) {
  constexpr double kScansBeforeStop = 1.5;  // The peak is interpolated between scans.
  base::LongColumn<detect::Fall> kept{scratch};
  for (const detect::Fall& slip : std::as_const(slips)) {
    const std::size_t pull = trace.belt.pull_of(estimate::time_at(trace, slip.peak_at));
    const bool pulled =
        estimate::time_at(trace, slip.peak_at) >= trace.belt.pull_start_s(pull) &&
        estimate::time_at(trace, slip.peak_at + kScansBeforeStop) < trace.belt.pull_end_s(pull);
    if (pulled) kept.push_back(slip);
  }
  slips = std::move(kept);
}

/// A cycle with a gap in it, longer than this many median ones, has lost a slip: cycles differ by less, and
/// two of them are longer.
constexpr double kLongestCycle = 1.5;

/// From a slip to the next.
double cycle_s(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& falls, std::size_t slip) {
  return estimate::time_at(trace, falls[slip + 1].peak_at) - estimate::time_at(trace, falls[slip].peak_at);
}

/// Length of the cycle that spans a gap; 0 before the first slip and after the last. \param at  first scan
/// after the gap.
double cycle_at_s(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& falls, std::size_t at) {
  std::size_t next = 0;  // The first slip after the gap.
  for (std::size_t step = std::bit_floor(falls.size()); step > 0; step /= 2) {
    if (next + step <= falls.size() && falls[next + step - 1].peak_at < static_cast<double>(at)) next += step;
  }
  return next == 0 || next == falls.size() ? 0.0 : cycle_s(trace, falls, next - 1);
}

/// Relative variation of the speed, from the first slip to the last, up to which it counts as constant: an
/// error of 1 % of the stick rate is within the precision of a single test.
constexpr double kOneSpeed = 0.01;

bool changes(const model::PullSpeed& speed, double from_s, double to_s, double resolution_m_per_s) {
  double least = speed.speed_m_per_s(from_s);
  double most = least;
  const auto look = [&](double speed_m_per_s) {
    least = std::min(least, speed_m_per_s);
    most = std::max(most, speed_m_per_s);
  };
  look(speed.speed_m_per_s(to_s));
  for (const model::SpeedPoint& point : speed.points()) {
    if (point.at_s > from_s && point.at_s < to_s) look(point.speed_m_per_s);
  }
  return most - least > std::max(2.0 * resolution_m_per_s, kOneSpeed * most);
}

}  // namespace

void TestAnalysis::break_at_gaps(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips) const {
  const base::LongColumn<base::ScanIndex>& indices = indices_;
  const base::LongColumn<detect::Fall>& falls = slips;
  if (gaps_.empty() || falls.empty()) return;
  // Peak and trough are half an oscillation apart: no gap that is shorter hides both, but what is left of a
  // slip may be too small for one. Whether a longer gap hides a slip, or three, no fit can tell; nor when it
  // happened, if the scans were not counted.
  const double half =
      signal::median_of(falls.size(), [&](std::size_t i) { return falls[i].trough_at - falls[i].peak_at; });
  const double longest_s =
      falls.size() < 2 ? 0.0 : kLongestCycle * signal::median_of(falls.size() - 1, [&](std::size_t i) {
                                 return cycle_s(trace, falls, i);
                               });
  for (const Gap& gap : gaps_) {
    trace.lost_s += static_cast<double>(gap.count) / settings_.scan_rate_Hz;
    const auto after = std::lower_bound(indices.begin(), indices.end(), gap.first);
    if (!gap.estimated && static_cast<double>(gap.count) < half &&
        cycle_at_s(trace, falls, static_cast<std::size_t>(after - indices.begin())) <= longest_s) {
      continue;
    }
    if (after != indices.begin() && after != indices.end()) {
      trace.breaks.push_back(static_cast<std::size_t>(after - indices.begin()));
    }
  }
  if (trace.breaks.empty()) return;
  base::LongColumn<detect::Fall> whole{settings_.scratch_folder};
  for (const detect::Fall& slip : falls) {
    // The last scan before a gap, and the first after it, turn nowhere.
    constexpr double kFlank = 1.0;
    if (!estimate::is_broken(trace, slip.peak_at - kFlank, slip.trough_at + kFlank)) whole.push_back(slip);
  }
  slips = std::move(whole);
}

void TestAnalysis::read_speeds(const estimate::Trace& trace) {
  const base::LongColumn<double>& speeds = speeds_m_per_s_;
  if (!settings_.speed_step_m_per_s || speeds.size() != trace.size()) return;
  const double step_m_per_s = *settings_.speed_step_m_per_s;
  speed_resolution_m_per_s_ = MeasuredSpeed::resolution(signal::scan_noise(speeds, 0.0), step_m_per_s);
  MeasuredSpeed measured{speed_resolution_m_per_s_};
  for (std::size_t i = 0; i < speeds.size(); ++i) measured.add(trace.time_s[i], speeds[i]);
  measured_speed_ = measured.course();
}

void TestAnalysis::follow_speed(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips) const {
  const base::LongColumn<detect::Fall>& falls = slips;
  if (measured_speed_) {
    // What was measured counts before what was planned.
    const double first_s = estimate::time_at(trace, falls[0].peak_at);
    const double last_s = estimate::time_at(trace, falls[falls.size() - 1].peak_at);
    if (!changes(*measured_speed_, first_s, last_s, speed_resolution_m_per_s_)) return;
    trace.belt = model::BeltMotion{*measured_speed_, std::as_const(trace.time_s)[0]};
  } else {
    // What the tester did counts before what the method asks.
    const auto& plan =
        settings_.tester.speed_course ? settings_.tester.speed_course : settings_.method.speed_course;
    if (!plan) return;
    const auto belt = belt_from_loading(trace, falls[0], *plan, settings_.tester.gravity_m_per_s2);
    if (!belt) return;
    trace.belt = *belt;
  }
  keep_pulled(trace, slips, settings_.scratch_folder);
}

void TestAnalysis::follow_holds(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips, double sigma,
                                TestResults& results) const {
  const std::optional<double>& speed = settings_.tester.pull_speed_m_per_s;
  if (measured_speed_ || settings_.tester.speed_course || settings_.method.speed_course) return;
  const std::vector<Hold> holds = find_holds(trace, slips, sigma);
  if (holds.empty()) return;
  const double begin_s = std::as_const(trace.time_s)[0];
  auto course = speed ? course_with_holds(*speed, begin_s, holds) : std::nullopt;
  base::add(results.findings,
            holds_finding(holds, course && !settings_.skipped.first_slip, speed.has_value()));
  if (!course) return;
  trace.belt = model::BeltMotion{*std::move(course), begin_s};
  keep_pulled(trace, slips, settings_.scratch_folder);
}

}  // namespace stickslip::analysis
