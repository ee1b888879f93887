#include "core/analysis/hum_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// In both lengths 50 and 60 Hz have whole numbers of cycles. The longer one parts the mains from a sled that
/// swings beside them; the shorter ones are many in a short test.
constexpr double kStretch_s = 0.2;
constexpr std::size_t kFewestStretches = 8;
constexpr double kStretchWithSlips_s = 1.0;
constexpr std::size_t kFewestStretchesWithSlips = 2;
/// Least amplitude, in drops of the slips, of hum that makes them: one half, less what scans miss of it. The
/// harmonics of a saw-tooth have 1/(2 pi) at most.
constexpr double kOfTheDrop = 0.25;
constexpr double kSignificant = 3.0;
/// An unloaded cell is below this part of the largest value.
constexpr double kLoadedPart = 1.0 / 3.0;

/// Amplitudes at the mains' frequencies, and the standard error of each of their components.
struct Stretch {
  double amplitude[std::size(kMains_Hz)] = {};
  double error = 0.0;
};

Stretch look_at(const std::vector<double>& values, double scan_rate_Hz) {
  const auto n = static_cast<double>(values.size());
  const double middle = 0.5 * (n - 1.0);
  double mean = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    mean += values[i] / n;
    slope += (static_cast<double>(i) - middle) * values[i];
  }
  slope *= 12.0 / (n * (n * n - 1.0));
  Stretch stretch;
  double squares = 0.0;
  double re[std::size(kMains_Hz)] = {};
  double im[std::size(kMains_Hz)] = {};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double at = static_cast<double>(i) - middle;
    const double rest = values[i] - mean - slope * at;
    squares += rest * rest;
    for (std::size_t k = 0; k < std::size(kMains_Hz); ++k) {
      const double phase = 2.0 * std::numbers::pi * kMains_Hz[k] * at / scan_rate_Hz;
      re[k] += 2.0 / n * rest * std::cos(phase);
      im[k] += 2.0 / n * rest * std::sin(phase);
    }
  }
  for (std::size_t k = 0; k < std::size(kMains_Hz); ++k) {
    stretch.amplitude[k] = std::hypot(re[k], im[k]);
    squares -= 0.5 * n * stretch.amplitude[k] * stretch.amplitude[k];
  }
  constexpr double kParameters = 6.0;
  stretch.error = std::sqrt(2.0 / n * std::max(squares, 0.0) / (n - kParameters));
  return stretch;
}

std::optional<Hum> hum_under_load(const estimate::Trace& trace, double scan_rate_Hz, double stretch_s,
                                  std::size_t fewest) {
  const base::LongColumn<double>& value = trace.value;
  const double largest = estimate::largest_value(trace);
  const auto scans = static_cast<std::size_t>(std::lround(stretch_s * scan_rate_Hz));
  std::vector<double> values;
  base::LongColumn<Stretch> stretches;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const bool goes_on = k == 0 || (trace.time_s[k] - trace.time_s[k - 1]) * scan_rate_Hz < 1.5;
    if (!goes_on || value[k] < kLoadedPart * largest) values.clear();
    if (value[k] < kLoadedPart * largest) continue;
    values.push_back(value[k]);
    if (values.size() < scans) continue;
    stretches.push_back(look_at(values, scan_rate_Hz));
    values.clear();
  }
  if (stretches.size() < fewest) return std::nullopt;
  const base::LongColumn<Stretch>& all = stretches;
  const double error = signal::median_of(all.size(), [&](std::size_t i) { return all[i].error; });
  std::optional<Hum> found;
  for (std::size_t k = 0; k < std::size(kMains_Hz); ++k) {
    const double amplitude =
        signal::median_of(all.size(), [&](std::size_t i) { return all[i].amplitude[k]; });
    if (amplitude - kSignificant * error <= kLargestHum) continue;
    if (!found || amplitude > found->amplitude) found = Hum{kMains_Hz[k], amplitude, false};
  }
  return found;
}

}  // namespace

std::optional<Hum> find_hum(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                            double scan_rate_Hz) {
  if (scan_rate_Hz < kLowestRateForHum_Hz || trace.size() == 0) return std::nullopt;
  if (slips.empty()) return hum_under_load(trace, scan_rate_Hz, kStretch_s, kFewestStretches);
  auto found = hum_under_load(trace, scan_rate_Hz, kStretchWithSlips_s, kFewestStretchesWithSlips);
  const double drop = signal::median_of(slips.size(), [&](std::size_t i) { return slips[i].robust_drop; });
  if (!found || found->amplitude < kOfTheDrop * drop) return std::nullopt;
  found->is_of_falls = true;
  return found;
}

base::Finding hum_finding(const Hum& hum, model::Regime regime) {
  std::string text =
      hum.is_of_falls
          ? fmt::format(
                "the falls are a wave of {:.4f} at {} Hz, the frequency of the mains: unless the sled itself "
                "swings so, "
                "regime, S and K are the hum's, and the sled slides",
                hum.amplitude, hum.frequency_Hz)
          : fmt::format(
                "hum of {:.4f} at {} Hz: slips that drop by less than {:.4f} are not told from sliding{}",
                hum.amplitude, hum.frequency_Hz, 2.0 * hum.amplitude,
                regime == model::Regime::kUndecided ? ", and the regime is undecided" : "");
  return base::make_finding(
      base::FindingCode::kHum, std::move(text),
      {{"hum", hum.amplitude, "1"}, {"frequency", hum.frequency_Hz, "Hz"}, {"limit", kLargestHum, "1"}});
}

}  // namespace stickslip::analysis
