#include "core/signal/held_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/signal/noise.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::signal {
namespace {

/// Fewest equal values that are called frozen.
constexpr std::size_t kFewestFrozen = 16;
/// An unloaded cell is below this part of the largest value.
constexpr double kLoadedPart = 1.0 / 3.0;
/// Where few blocks tell the noise, the quietest of them may be off by a factor of two; of eight and more it
/// is below the true noise but for one case in 300, and then by a few percent.
constexpr std::size_t kFewBlocks = 8;
constexpr double kOfFewBlocks = 0.5;
constexpr double kOfManyBlocks = 0.8;
/// Bands below the largest value, in steps and in σ.
constexpr double kBandSteps = 2.0;
constexpr std::array<double, 3> kBandSigmas{0.25, 1.0, 2.0};
constexpr double kBands = 5.0;

/// Largest usable value; −∞ if there is none.
double largest_of(const base::LongColumn<double>& values, const LeftOut& left_out) {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!left_out(k)) largest = std::max(largest, values[k]);
  }
  return largest;
}

/// The smallest noise of blocks of scans that are usable and not held, with its margin; 0 if there is no
/// block.
template <typename IsHeld>
double quietest_noise(const base::LongColumn<double>& values, const LeftOut& left_out, IsHeld is_held) {
  std::array<double, kFewestScansForNoise> block{};
  std::size_t filled = 0;
  std::size_t blocks = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (left_out(k) || is_held(k, values[k])) {
      filled = 0;
      continue;
    }
    block[filled++] = values[k];
    if (filled < block.size()) continue;
    smallest = std::min(smallest, scan_noise(block, 0.0));
    ++blocks;
    filled = 0;
  }
  if (blocks == 0) return 0.0;
  return (blocks < kFewBlocks ? kOfFewBlocks : kOfManyBlocks) * smallest;
}

/// Largest probability that a scan lies in the band. \param width  between the values as rounded.
double in_band(double width, double step, double sigma) {
  const double rounding = kRoundingSigma * step;
  const double variance = sigma * sigma - rounding * rounding;
  if (!(variance > 0.0)) return 1.0;
  return std::erf((width + step) / (2.0 * std::numbers::sqrt2 * std::sqrt(variance)));
}

/// Kullback-Leibler divergence of two coins, for share > p.
double divergence(double share, double p) {
  const double heads = share * std::log(share / p);
  return share < 1.0 ? heads + (1.0 - share) * std::log((1.0 - share) / (1.0 - p)) : heads;
}

/// The step of a converter that is not known: the smallest difference of neighbours, if all are multiples of
/// it and a tenth of them is zero; else 0. A tester that exports forces has such values.
double step_seen(const base::LongColumn<double>& values) {
  constexpr double kOff = 0.01;
  constexpr double kFewestEqual = 0.1;
  const double step = smallest_step(values);
  if (!(step > 0.0)) return 0.0;
  std::size_t equal = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double steps = (values[k] - values[k - 1]) / step;
    // The values have been printed, and so has the smallest of their differences.
    if (!(std::abs(steps - std::round(steps)) < kOff * (1.0 + 0.1 * std::abs(steps)))) return 0.0;
    equal += steps == 0.0 ? 1 : 0;
  }
  return static_cast<double>(equal) >= kFewestEqual * static_cast<double>(values.size()) ? step : 0.0;
}

/// Scans of a band below the largest value.
struct Tops {
  HeldValues held;
  double followed = 0.0;  ///< Scans at the top with another one behind them.
  double judged = 0.0;    ///< Scans at the top that have a usable one behind them.
  std::size_t run = 0;    ///< Latest scans at the top.

  void add(std::size_t scan, double value, bool usable) {
    const bool at_top = usable && held.holds(value);
    if (run > 0 && usable) ++judged;
    if (!at_top) {
      run = 0;
      return;
    }
    if (run > 0) ++followed;
    held.run_count += run == 0 ? 1 : 0;
    ++held.scan_count;
    if (++run > held.longest) {
      held.longest = run;
      held.first = scan + 1 - run;
    }
  }
};

}  // namespace

std::optional<HeldValues> flat_top(const base::LongColumn<double>& values, const LeftOut& left_out,
                                   double step) {
  const double largest = largest_of(values, left_out);
  if (!(largest > 0.0) || !(step > 0.0)) return std::nullopt;
  // Half a step more, as two values of one code may differ by rounding.
  const double steps = (kBandSteps + 0.5) * step;
  const double sigma = quietest_noise(
      values, left_out, [&](std::size_t /*scan*/, double value) { return value >= largest - steps; });
  const auto count = static_cast<double>(values.size());
  const double enough = std::log(kBands * count * count / kFalseAlarm);
  const std::array bands{0.5 * step, steps, kBandSigmas[0] * sigma, kBandSigmas[1] * sigma,
                         kBandSigmas[2] * sigma};
  std::array<Tops, bands.size()> tops_of;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    tops_of[i].held.lowest = largest - bands[i];
    tops_of[i].held.highest = largest;
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = values[k];
    const bool usable = !left_out(k);
    for (Tops& tops : tops_of) tops.add(k, value, usable);
  }
  std::optional<HeldValues> found;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double p = in_band(bands[i], step, sigma);
    const Tops& tops = tops_of[i];
    if (tops.judged == 0.0 || p >= 1.0) continue;
    const double share = tops.followed / tops.judged;
    if (share <= p || tops.judged * divergence(share, p) < enough) continue;
    if (!found || tops.held.scan_count > found->scan_count) found = tops.held;
  }
  return found;
}

std::optional<HeldValues> frozen_values(const base::LongColumn<double>& values, const LeftOut& left_out,
                                        double step) {
  const double lowest = kLoadedPart * largest_of(values, left_out);
  if (!(lowest > 0.0)) return std::nullopt;
  HeldValues held;
  held.run_count = 1;
  std::size_t run = 0;
  double before = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double value = values[k];
    const bool counts = !left_out(k) && value >= lowest;
    run = !counts ? 0 : run > 0 && value == before ? run + 1 : 1;
    before = value;
    if (run <= held.longest) continue;
    held.longest = held.scan_count = run;
    held.first = k + 1 - run;
    held.lowest = held.highest = value;
  }
  if (held.longest < kFewestFrozen || !(step > 0.0)) return std::nullopt;
  const double sigma = quietest_noise(values, left_out, [&](std::size_t scan, double /*value*/) {
    return scan >= held.first && scan < held.first + held.longest;
  });
  const double p = in_band(0.0, step, sigma);
  const auto length = static_cast<double>(held.longest);
  const double log_probability =
      std::log(static_cast<double>(values.size()) * length) + (length - 1.0) * std::log(p);
  if (log_probability > std::log(kFalseAlarm)) return std::nullopt;
  return held;
}

std::optional<double> noise_in_steps(const base::LongColumn<double>& values, const LeftOut& left_out,
                                     double step, const std::optional<HeldValues>& held) {
  const double lowest = kLoadedPart * largest_of(values, left_out);
  if (step <= 0.0) step = step_seen(values);
  if (!(lowest > 0.0) || !(step > 0.0)) return std::nullopt;
  FourthDifferences differences;
  std::vector<double> variances;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (left_out(k) || values[k] < lowest || (held && held->holds(values[k]))) {
      differences.gap();
    } else if (differences.add(values[k] / step)) {
      // Differences of few steps are whole numbers, of which the median tells little.
      double sum = 0.0;
      for (const double difference : differences.block()) sum += difference * difference;
      variances.push_back(sum / (FourthDifferences::kBlock * FourthDifferences::kVarianceGain));
    }
  }
  if (variances.size() < kFewBlocks) return std::nullopt;
  const double variance = median_of(variances.size(), [&](std::size_t i) { return variances[i]; });
  return std::sqrt(std::max(0.0, variance - kRoundingSigma * kRoundingSigma));
}

}  // namespace stickslip::signal
