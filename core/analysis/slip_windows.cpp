#include "core/analysis/slip_windows.hpp"

#include <algorithm>
#include <numbers>

#include "core/analysis/slip_guess.hpp"

namespace stickslip::analysis {
namespace {

/// Fewest slips for which the last may be left out because the pull ended in it.
constexpr std::size_t kFewestForEndOfPull = 4;

/// Part of the loading during which the motor reaches its speed.
constexpr double kRoundedStart = 0.2;

/// A window of a free oscillation ends this many periods after the trough of its last slip: by
/// then the amplitude is below what makes a slip significant.
constexpr double kTailPeriods = 1.5;

}  // namespace

std::size_t pull_of(const estimate::Trace& trace, const detect::Fall& slip) {
  return trace.belt.is_constant() ? 0 : trace.belt.pull_of(estimate::time_at(trace, slip.peak_at));
}

bool pull_ended_in_last_slip(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                             const model::SharedParameters& shared) {
  constexpr double kClimbs = 0.5;
  if (slips.size() < kFewestForEndOfPull) return false;
  const double period = 2.0 * std::numbers::pi / shared.omega * scans_per_s(trace);
  const double trough = trough_at(trace, slips.back(), shared);
  const std::size_t begin = scan_at(trough + 0.5 * period);
  const std::size_t end = scan_at(trough + 2.5 * period);
  if (end >= trace.size() || estimate::is_broken(trace, trough, static_cast<double>(end))) return false;
  const double rise = trace.value[end] - trace.value[begin];
  return rise <
         kClimbs * trace.belt.climb(shared.r, trace.time_s[begin], trace.time_s[end] - trace.time_s[begin]);
}

std::size_t end_of_pull(const estimate::Trace& trace, const detect::Fall& slip) {
  if (trace.belt.is_constant()) return trace.size();
  const double end_s = trace.belt.pull_end_s(pull_of(trace, slip));
  return estimate::scan_at_or_after(trace, end_s, std::min(scan_at(slip.peak_at), trace.size()));
}

std::size_t boundary(const detect::Fall& before, const detect::Fall& after) {
  return scan_at(0.5 * (before.trough_at + after.peak_at));
}

std::size_t start_of_loading(const estimate::Trace& trace, const detect::Fall& first,
                             const model::SharedParameters& shared) {
  const std::size_t peak = scan_at(first.peak_at);
  std::size_t start = peak - std::min(static_cast<std::size_t>(first.rise_duration), peak);
  const double rest = level_before(trace, first);
  const double K = 0.5 * (first.peak + first.trough) - rest;
  const double rate = rate_at(trace, first, shared);
  const double caught_up = 2.0 * rate * rate / (shared.oscillator().omega0_squared() * K);
  const double range = first.peak - rest;
  const double level = rest + std::clamp(caught_up, kRoundedStart * range, range);
  for (std::size_t k = start; k < peak; ++k) {
    if (trace.value[k] < level) start = k + 1;
  }
  if (!trace.belt.is_constant()) {
    const double pulls_s = trace.belt.pull_start_s(pull_of(trace, first));
    while (start < peak && trace.time_s[start] < pulls_s) ++start;
  }
  for (const std::size_t after_gap : trace.breaks) {
    if (after_gap <= peak) start = std::max(start, after_gap);
  }
  return start;
}

bool begins_a_pull(const estimate::Trace& trace, std::span<const detect::Fall> slips, std::size_t i) {
  return i == 0 || pull_of(trace, slips[i - 1]) != pull_of(trace, slips[i]);
}

bool is_held_between(const estimate::Trace& trace, const detect::Fall& before, const detect::Fall& after) {
  return trace.belt.is_held_between(estimate::time_at(trace, before.peak_at),
                                    estimate::time_at(trace, after.peak_at));
}

double rests_from_s(const estimate::Trace& trace, const detect::Fall& slip, double trough_s, double cycle_s) {
  const double stop_s = *trace.belt.held_from_s(pull_of(trace, slip));
  return stop_s - trough_s <= 2.0 * cycle_s ? trough_s : std::max(stop_s, trough_s);
}

bool follows_a_break(const estimate::Trace& trace, std::span<const detect::Fall> slips, std::size_t i) {
  const double from = i > 0 ? slips[i - 1].peak_at : slips[i].peak_at - slips[i].rise_duration;
  return estimate::is_broken(trace, from, slips[i].peak_at);
}

void lay_windows(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                 const model::SharedParameters& shared, SlipEstimates& estimates) {
  estimates.windows.clear();
  estimates.window_of_slip.clear();
  const double period_s = 2.0 * std::numbers::pi / shared.omega;
  const bool cut = pull_ended_in_last_slip(trace, slips, shared);
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const bool loading = begins_a_pull(trace, slips, i);
    const bool begins = loading || estimates.ends[i - 1] == SlipEnd::kCaptured;
    // After a break it is unknown whether the sled stuck, until a slip has ended in sticking.
    const bool unknown = !begins && !estimates.has_window(i - 1);
    if (unknown || ((i == 0 || !loading) && follows_a_break(trace, slips, i))) {
      estimates.window_of_slip.push_back(SlipEstimates::kNoWindow);
      continue;
    }
    if (cut && i + 1 == slips.size() && estimates.ends[i - 1] != SlipEnd::kFree) {
      estimates.window_of_slip.push_back(SlipEstimates::kNoWindow);
      break;
    }
    if (begins) {
      estimate::SlipWindow window;
      window.first = loading ? start_of_loading(trace, slips[i], shared) : boundary(slips[i - 1], slips[i]);
      window.slip = first_guess(trace, slips[i], shared);
      estimates.windows.push_back(window);
    }
    estimates.window_of_slip.push_back(estimates.windows.size() - 1);
    estimate::SlipWindow& window = estimates.windows.back();
    window.captured = estimates.ends[i] != SlipEnd::kFree;
    if (i + 1 < slips.size() && !begins_a_pull(trace, slips, i + 1) &&
        !follows_a_break(trace, slips, i + 1)) {
      window.end = boundary(slips[i], slips[i + 1]);
    } else {
      // Up to the trough the two courses are the same; a free oscillation has a tail to learn from.
      const bool free_before = !loading && estimates.ends[i - 1] == SlipEnd::kFree;
      window.captured = !free_before;
      const double tail = free_before ? kTailPeriods * period_s * scans_per_s(trace) : 0.0;
      window.end = scan_at(trough_at(trace, slips[i], shared) + tail) + 1;
    }
    window.end = std::min({window.end, trace.size(), end_of_pull(trace, slips[i])});
    const auto after_gap =
        std::upper_bound(trace.breaks.begin(), trace.breaks.end(), scan_at(slips[i].trough_at));
    if (after_gap != trace.breaks.end()) window.end = std::min(window.end, *after_gap);
  }
}

bool windows_suffice(const estimate::Trace& trace, const std::vector<estimate::SlipWindow>& windows) {
  constexpr std::ptrdiff_t kFewestScans = 4;
  return !windows.empty() &&
         std::all_of(windows.begin(), windows.end(), [&](const estimate::SlipWindow& window) {
           if (window.first >= window.end) return false;
           const auto first = trace.usable.begin() + static_cast<std::ptrdiff_t>(window.first);
           const auto end = trace.usable.begin() + static_cast<std::ptrdiff_t>(window.end);
           return std::count(first, end, 1) >= kFewestScans;
         });
}

}  // namespace stickslip::analysis
