#include "core/analysis/traditional.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/analysis/slip_estimator.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// So many scans at the beginning tell whether the trace begins under load; a spike among them does not.
constexpr std::ptrdiff_t kFirstScans = 5;

/// Mean of the usable scans in [first, end) but those during which the belt stood still, without large sums.
Estimate mean_of(const estimate::Trace& trace, std::size_t first, std::size_t end) {
  signal::RunningMean mean;
  bool any_usable = false;
  for (std::size_t k = first; k < end; ++k) {
    if (trace.usable[k] == 0) continue;
    any_usable = true;
    if (trace.belt.relative(trace.time_s[k]) != 0.0) mean.add(trace.value[k]);
  }
  if (mean.count > 0.0) return Estimate::of(mean.mean);
  return Estimate::none(any_usable ? "the belt stood still in the whole window"
                                   : "no scan of the window is usable");
}

/// Scans between the first and the last at or above half the largest: what is before is loading, what
/// is after unloading.
std::pair<std::size_t, std::size_t> loaded_part(const estimate::Trace& trace) {
  const double half = 0.5 * estimate::largest_value(trace);
  const auto loaded = [half](double value) { return value >= half; };
  const auto first = std::find_if(trace.value.begin(), trace.value.end(), loaded);
  const auto last = std::find_if(trace.value.rbegin(), trace.value.rend(), loaded);
  if (first == trace.value.end()) return {0, trace.size()};
  return {static_cast<std::size_t>(first - trace.value.begin()),
          trace.size() - static_cast<std::size_t>(last - trace.value.rbegin())};
}

/// Largest scan of the peak.
Estimate largest_scan(const estimate::Trace& trace, const detect::Fall& slip) {
  const auto peak = static_cast<std::size_t>(std::lround(slip.peak_at));
  const std::size_t last = std::min(peak + 1, trace.size() - 1);
  double largest = trace.value[peak];
  for (std::size_t k = peak > 0 ? peak - 1 : 0; k <= last; ++k) largest = std::max(largest, trace.value[k]);
  return Estimate::of(largest);
}

/// Peak to peak: a whole number of cycles, so that the phase does not matter.
Estimate mean_of_cycles(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                        int cycles) {
  const auto wanted = static_cast<std::size_t>(cycles);
  if (slips.size() < 2) return Estimate::none("only one peak: no cycle to average over");
  const double begin_s = estimate::time_at(trace, slips.front().peak_at);
  const std::size_t last_peak = std::min(wanted, slips.size() - 1);
  double end_s = estimate::time_at(trace, slips[last_peak].peak_at);
  if (last_peak < wanted) {
    // An oscillation that has died away still lasts: go on with its mean period, if the trace does.
    const double period_s = (end_s - begin_s) / static_cast<double>(last_peak);
    const double wanted_end_s = begin_s + static_cast<double>(wanted) * period_s;
    if (wanted_end_s > trace.time_s.back()) {
      return Estimate::none(
          fmt::format("{} cycles after the first peak, the method wants {}", last_peak, cycles));
    }
    end_s = wanted_end_s;
  }
  return mean_of(trace, estimate::scan_at_or_after(trace, begin_s, 0),
                 estimate::scan_at_or_after(trace, end_s, 0));
}

/// \param start_s  of the travel.
Estimate mean_of_travel(const estimate::Trace& trace, double start_s, const model::TravelWindow& window,
                        std::optional<double> pull_speed_m_per_s) {
  if (!pull_speed_m_per_s) {
    return Estimate::none("the method averages over a travel, and the pull speed is not known");
  }
  const double end_s = start_s + window.to_m / *pull_speed_m_per_s;
  if (end_s > trace.time_s.back()) {
    return Estimate::none(fmt::format("{:.4g} m of travel after the first peak, the method wants {:.4g} m",
                                      (trace.time_s.back() - start_s) * *pull_speed_m_per_s, window.to_m));
  }
  const std::size_t first =
      estimate::scan_at_or_after(trace, start_s + window.from_m / *pull_speed_m_per_s, 0);
  const std::size_t end = estimate::scan_at_or_after(trace, end_s, first);
  if (first == end) return Estimate::none("no scan within the method's travel");
  return mean_of(trace, first, end);
}

}  // namespace

Estimate mean_force(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips) {
  const int cycles = static_cast<int>(slips.size()) - 1;
  const Estimate to_the_end = mean_of_cycles(trace, slips, std::max(cycles, model::Method{}.kinetic_cycles));
  return to_the_end.value || cycles < 1 ? to_the_end : mean_of_cycles(trace, slips, cycles);
}

bool begins_under_load(const estimate::Trace& trace) {
  const double half = 0.5 * estimate::largest_value(trace);
  const auto first = std::min<std::ptrdiff_t>(kFirstScans, static_cast<std::ptrdiff_t>(trace.size()));
  const auto loaded = std::count_if(trace.value.begin(), trace.value.begin() + first,
                                    [half](double value) { return value >= half; });
  return 2 * loaded > first;
}

TraditionalCoefficients traditional_coefficients(const estimate::Trace& trace,
                                                 const base::LongColumn<detect::Fall>& slips,
                                                 const model::Method& method,
                                                 std::optional<double> pull_speed_m_per_s) {
  TraditionalCoefficients result;
  if (slips.empty()) {
    const auto [first, end] = loaded_part(trace);
    result.static_coefficient = Estimate::none("no peak: the force never fell by a slip");
    result.kinetic_coefficient =
        method.kinetic_travel
            ? mean_of_travel(trace, trace.time_s[first], *method.kinetic_travel, pull_speed_m_per_s)
            : mean_of(trace, first, end);
    return result;
  }
  const auto wanted = static_cast<std::size_t>(method.static_slip);
  result.static_coefficient =
      slips.size() < wanted ? Estimate::none(fmt::format("{} slips, the method reads the peak of slip {}",
                                                         slips.size(), wanted))
                            : largest_scan(trace, slips[wanted - 1]);
  result.kinetic_coefficient = method.kinetic_travel
                                   ? mean_of_travel(trace, estimate::time_at(trace, slips.front().peak_at),
                                                    *method.kinetic_travel, pull_speed_m_per_s)
                                   : mean_of_cycles(trace, slips, method.kinetic_cycles);
  return result;
}

}  // namespace stickslip::analysis
