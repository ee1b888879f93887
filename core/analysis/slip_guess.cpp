#include "core/analysis/slip_guess.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/model/tester.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// A rise that starts below this part of its peak is the loading of a test from rest.
constexpr double kLoadingStartsBelow = 0.5;

/// Least-squares slope of the rise to `peak` from the turning point before, between levels `low`
/// and `high` (parts of the rise): there the sled sticks and the force rises at the rate r.
double slope_of_rise(const estimate::Trace& trace, const detect::Fall& fall, double low, double high) {
  const std::size_t peak = std::min(scan_at(fall.peak_at), trace.size() - 1);
  const std::size_t length = std::min(static_cast<std::size_t>(fall.rise_duration), peak);
  const double range = fall.peak - fall.rise_from;
  double n = 0.0;
  double mean_t = 0.0;
  double mean_c = 0.0;
  double s_tt = 0.0;
  double s_tc = 0.0;
  for (std::size_t k = peak - length; k <= peak; ++k) {
    const double level = (trace.value[k] - fall.rise_from) / range;
    if (trace.usable[k] == 0 || level < low || level > high) continue;
    // Running means: no difference of large sums [Welford, Technometrics 4(3):419–420, 1962].
    n += 1.0;
    const double dt = trace.time_s[k] - mean_t;
    mean_t += dt / n;
    mean_c += (trace.value[k] - mean_c) / n;
    s_tt += dt * (trace.time_s[k] - mean_t);
    s_tc += dt * (trace.value[k] - mean_c);
  }
  if (n >= 2.0 && s_tt > 0.0) return s_tc / s_tt;
  return length > 0 ? range / (trace.time_s[peak] - trace.time_s[peak - length]) : 0.0;
}

/// Slope of the loading from rest: upper quartile of those over an eighth of it, or from scan to scan if it
/// is shorter. It begins less steep, while a sled that a fast start of the belt has left behind catches up,
/// and ends so, where it slips. There must be a scan before the peak.
double slope_of_loading(const estimate::Trace& trace, const detect::Fall& first) {
  constexpr double kFrom = 0.1;
  constexpr double kTo = 0.95;
  constexpr std::size_t kParts = 8;
  const std::size_t peak = std::min(scan_at(first.peak_at), trace.size() - 1);
  const double rest = level_before(trace, first);
  const auto at_least = [&](std::size_t k, double level) {
    return trace.value[k] >= rest + level * (first.peak - rest);
  };
  std::size_t begin = peak;
  while (begin > 0 && at_least(begin - 1, kFrom)) --begin;
  const std::size_t lag = std::max<std::size_t>((peak - begin) / kParts, 1);
  std::vector<double> slopes;
  for (std::size_t k = begin; k + lag <= peak && !at_least(k + lag, kTo); ++k) {
    if (trace.usable[k] == 0 || trace.usable[k + lag] == 0) continue;
    slopes.push_back((trace.value[k + lag] - trace.value[k]) / (trace.time_s[k + lag] - trace.time_s[k]));
  }
  if (slopes.empty()) {
    for (std::size_t k = std::max<std::size_t>(begin, 1); k <= peak; ++k) {
      slopes.push_back((trace.value[k] - trace.value[k - 1]) / (trace.time_s[k] - trace.time_s[k - 1]));
    }
    return *std::max_element(slopes.begin(), slopes.end());
  }
  const auto quartile = slopes.begin() + static_cast<std::ptrdiff_t>(3 * slopes.size() / 4);
  std::nth_element(slopes.begin(), quartile, slopes.end());
  return *quartile;
}

}  // namespace

std::size_t scan_at(double position) {
  return static_cast<std::size_t>(std::lround(std::max(position, 0.0)));
}

double level_before(const estimate::Trace& trace, const detect::Fall& fall) {
  constexpr std::size_t kReach = 3;
  const std::size_t turn = scan_at(fall.peak_at - fall.rise_duration);
  std::vector<double> levels;
  for (std::size_t k = turn > kReach ? turn - kReach : 0; k <= turn + kReach && k < trace.size(); ++k) {
    levels.push_back(trace.value[k]);
  }
  return signal::median(levels);
}

double slope_of_sticks(const estimate::Trace& trace, std::span<const detect::Fall> slips) {
  std::vector<double> slopes;
  for (const detect::Fall& slip : slips) {
    const double slope = slope_of_rise(trace, slip, 0.3, 0.7);
    const double relative =
        trace.belt.is_constant()
            ? 1.0
            : trace.belt.relative(estimate::time_at(trace, slip.peak_at - 0.5 * slip.rise_duration));
    if (relative > 0.0) slopes.push_back(slope / relative);
  }
  return slopes.empty() ? slope_of_rise(trace, slips.front(), 0.3, 0.7) : signal::median(slopes);
}

model::SharedParameters first_guess(const estimate::Trace& trace, std::span<const detect::Fall> slips) {
  std::vector<double> half_periods;
  for (const detect::Fall& slip : slips) {
    // Maximum and minimum of a damped oscillation are π/ω apart, whatever γ and the drift.
    half_periods.push_back(estimate::time_at(trace, slip.trough_at) - estimate::time_at(trace, slip.peak_at));
  }
  model::SharedParameters shared;
  shared.omega = std::numbers::pi / signal::median(half_periods);
  shared.gamma = 2.0 * model::kTypicalGammaOver2Omega * shared.omega;
  const detect::Fall& first = slips.front();
  const bool from_loading = trace.belt.is_constant() && scan_at(first.peak_at) > 0 &&
                            level_before(trace, first) < kLoadingStartsBelow * first.peak;
  shared.r = from_loading ? slope_of_loading(trace, first) : slope_of_sticks(trace, slips);
  return shared;
}

double rate_at(const estimate::Trace& trace, const detect::Fall& slip,
               const model::SharedParameters& shared) {
  return trace.belt.is_constant() ? shared.r
                                  : trace.belt.stick_rate(shared.r, estimate::time_at(trace, slip.peak_at));
}

model::SlipParameters first_guess(const estimate::Trace& trace, const detect::Fall& slip,
                                  const model::SharedParameters& shared) {
  const double amplitude = 0.5 * slip.drop();
  const double belt = rate_at(trace, slip, shared) / shared.omega;
  // [2] without damping: amplitude² = D² + (r/ω)².
  const double D = std::sqrt(std::max(amplitude * amplitude - belt * belt, 0.01 * amplitude * amplitude));
  model::SlipParameters parameters;
  parameters.K = 0.5 * (slip.peak + slip.trough) - trace.drift.at(estimate::time_at(trace, slip.peak_at));
  parameters.S = parameters.K + D;
  parameters.onset_s = estimate::time_at(trace, slip.peak_at) - std::atan2(belt, D) / shared.omega;
  return parameters;
}

double scans_per_s(const estimate::Trace& trace) {
  return static_cast<double>(trace.size() - 1) / (trace.time_s.back() - trace.time_s.front() - trace.lost_s);
}

double trough_at(const estimate::Trace& trace, const detect::Fall& slip,
                 const model::SharedParameters& shared) {
  constexpr double kMargin = 1.15;  // For the first guess of ω.
  return std::min(slip.trough_at,
                  slip.peak_at + kMargin * std::numbers::pi / shared.omega * scans_per_s(trace));
}

double typical_delta_mu(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                        const model::SharedParameters& shared) {
  std::vector<double> D;
  double largest = 0.0;
  for (const detect::Fall& slip : slips) {
    const double belt = rate_at(trace, slip, shared) / shared.omega;
    const double amplitude = 0.5 * slip.drop();
    largest = std::max(largest, amplitude);
    if (amplitude > belt) D.push_back(std::sqrt(amplitude * amplitude - belt * belt));
  }
  return D.empty() ? largest : signal::median(D);
}

}  // namespace stickslip::analysis
