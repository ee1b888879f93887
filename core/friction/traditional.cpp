#include "core/friction/traditional.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/friction/slip_estimator.hpp"

namespace stickslip::friction {
namespace {

/// Mean of the usable scans in [first, end), without large sums [Welford 1962].
double mean_of(const Trace& trace, std::size_t first, std::size_t end) {
  double mean = 0.0;
  double n = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    if (trace.usable[k] == 0) continue;
    n += 1.0;
    mean += (trace.value[k] - mean) / n;
  }
  return mean;
}

/// Scans between the first and the last at or above half the largest: what is before is loading, what
/// is after unloading.
std::pair<std::size_t, std::size_t> loaded_part(const Trace& trace) {
  const double half = 0.5 * *std::max_element(trace.value.begin(), trace.value.end());
  const auto loaded = [half](double value) { return value >= half; };
  const auto first = std::find_if(trace.value.begin(), trace.value.end(), loaded);
  const auto last = std::find_if(trace.value.rbegin(), trace.value.rend(), loaded);
  if (first == trace.value.end()) return {0, trace.size()};
  return {static_cast<std::size_t>(first - trace.value.begin()),
          trace.size() - static_cast<std::size_t>(last - trace.value.rbegin())};
}

std::size_t first_at_or_after(const Trace& trace, double time_s) {
  const auto found = std::lower_bound(trace.time_s.begin(), trace.time_s.end(), time_s);
  return static_cast<std::size_t>(found - trace.time_s.begin());
}

}  // namespace

TraditionalCoefficients traditional_coefficients(const Trace& trace, std::span<const Fall> slips,
                                                 const Method& method) {
  if (slips.empty()) {
    const auto [first, end] = loaded_part(trace);
    return {Estimate::none("no peak: the force never fell by a slip"),
            Estimate::of(mean_of(trace, first, end))};
  }
  TraditionalCoefficients result;
  const auto peak = static_cast<std::size_t>(std::lround(slips.front().peak_at));
  const std::size_t last = std::min(peak + 1, trace.size() - 1);
  double largest = trace.value[peak];
  for (std::size_t k = peak > 0 ? peak - 1 : 0; k <= last; ++k) largest = std::max(largest, trace.value[k]);
  result.static_coefficient = Estimate::of(largest);

  // Peak to peak: a whole number of cycles, so that the phase does not matter.
  const auto wanted = static_cast<std::size_t>(method.kinetic_cycles);
  if (slips.size() < 2) {
    result.kinetic_coefficient = Estimate::none("only one peak: no cycle to average over");
    return result;
  }
  const double begin_s = time_at(trace, slips.front().peak_at);
  const std::size_t last_peak = std::min(wanted, slips.size() - 1);
  double end_s = time_at(trace, slips[last_peak].peak_at);
  if (last_peak < wanted) {
    // An oscillation that has died away still lasts: go on with its mean period, if the trace does.
    const double period_s = (end_s - begin_s) / static_cast<double>(last_peak);
    const double wanted_end_s = begin_s + static_cast<double>(wanted) * period_s;
    if (wanted_end_s > trace.time_s.back()) {
      result.kinetic_coefficient = Estimate::none(fmt::format(
          "{} cycles after the first peak, the method wants {}", last_peak, method.kinetic_cycles));
      return result;
    }
    end_s = wanted_end_s;
  }
  result.kinetic_coefficient =
      Estimate::of(mean_of(trace, first_at_or_after(trace, begin_s), first_at_or_after(trace, end_s)));
  return result;
}

}  // namespace stickslip::friction
