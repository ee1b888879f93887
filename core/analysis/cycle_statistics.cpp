#include "core/analysis/cycle_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <boost/math/distributions/students_t.hpp>

#include "core/analysis/slip_estimator.hpp"
#include "core/analysis/slip_windows.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/signal/statistics.hpp"
#include "core/signal/wandering_mean.hpp"

namespace stickslip::analysis {

namespace {

constexpr std::size_t kFewestPeriods = 3;
/// Significance level of the drift: the probability that a test without drift is corrected for one. Such an
/// error costs little: it turns K about the middle of the test by the slope's own error. A real drift that is
/// not corrected costs more: it makes the first slip of a short ring-down look captured.
constexpr double kDriftLevel = 0.01;

/// Whether a cycle ends at the next slip: without a break and without a hold between them.
bool goes_on(const estimate::Trace& trace, const detect::Fall& slip, const detect::Fall& next) {
  return !estimate::is_broken(trace, slip.peak_at, next.peak_at) && !is_held_between(trace, slip, next);
}

/// From one peak to the next.
std::size_t whole_cycles(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips) {
  std::size_t count = slips.size() - std::min<std::size_t>(slips.size(), 1);
  const bool whole = trace.breaks.empty() && trace.belt.is_constant();
  for (std::size_t i = 0; !whole && i + 1 < slips.size(); ++i) {
    if (!goes_on(trace, slips[i], slips[i + 1])) --count;
  }
  return count;
}

/// The level about which peak, trough and next peak swing. Aitken's Δ² [Proc. R. Soc. Edinburgh 46:289, 1926]
/// is exact for a damped oscillation, where their mean lies too high by a part of the decay, and is the mean
/// of peak and trough where the next peak is as high.
double centre(const detect::Fall& slip, double next_peak) {
  const double turns = slip.peak + next_peak - 2.0 * slip.trough;
  return (slip.peak * next_peak - slip.trough * slip.trough) / turns;
}

}  // namespace

Estimate drift_of(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips) {
  const std::size_t count = whole_cycles(trace, slips);
  if (count < kFewestPeriods) return Estimate::none("fewer than three cycles");
  // Worked out twice, for the mean and for the slope: there may be more than memory should hold.
  const auto for_each_mean = [&](const auto& take) {
    for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
      if (!goes_on(trace, slips[i], slips[i + 1])) continue;
      const auto first = static_cast<std::size_t>(std::lround(slips[i].peak_at));
      const auto end = static_cast<std::size_t>(std::lround(slips[i + 1].peak_at));
      double mean = 0.0;
      for (std::size_t k = first; k < end; ++k) mean += trace.value[k] / static_cast<double>(end - first);
      take(0.5 * (trace.time_s[first] + trace.time_s[end]), mean);
    }
  };
  const auto n = static_cast<double>(count);
  double mean_t = 0.0;
  double mean_c = 0.0;
  for_each_mean([&](double t, double c) {
    mean_t += t / n;
    mean_c += c / n;
  });
  double s_tt = 0.0;
  double s_tc = 0.0;
  double s_cc = 0.0;
  for_each_mean([&](double t, double c) {
    s_tt += (t - mean_t) * (t - mean_t);
    s_tc += (t - mean_t) * (c - mean_c);
    s_cc += (c - mean_c) * (c - mean_c);
  });
  const double slope = s_tc / s_tt;
  const double residual_variance = std::max(s_cc - slope * s_tc, 0.0) / (n - 2.0);
  return Estimate::of(slope, std::sqrt(residual_variance / s_tt));
}

estimate::Drift significant_drift(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips) {
  const Estimate slope = drift_of(trace, slips);
  if (!slope.value || !slope.standard_error) return {};
  const auto freedom = static_cast<double>(whole_cycles(trace, slips) - 2);
  const double limit =
      boost::math::quantile(boost::math::complement(boost::math::students_t{freedom}, 0.5 * kDriftLevel));
  if (!(std::abs(*slope.value) > limit * *slope.standard_error)) return {};
  double mean_s = 0.0;
  for (std::size_t i = 1; i < slips.size(); ++i) {
    mean_s += estimate::time_at(trace, slips[i].peak_at) / static_cast<double>(slips.size() - 1);
  }
  return {*slope.value, mean_s};
}

std::optional<base::Finding> level_finding(const estimate::Trace& trace,
                                           const base::LongColumn<detect::Fall>& slips) {
  constexpr std::size_t kFewestCycles = 24;  // Eight in a third: fewer tell nothing of how they wander.
  constexpr double kLevel = 0.0027;          // Three standard deviations.
  if (slips.size() < kFewestCycles + 1 || !trace.belt.is_constant()) return std::nullopt;
  const std::size_t cycles = slips.size() - 1;
  const std::size_t third = cycles / 3;
  const auto mean_from = [&](std::size_t first) {
    signal::WanderingMean mean;
    for (std::size_t i = first; i < first + third; ++i) {
      const detect::Fall slip = slips[i];
      const detect::Fall next = slips[i + 1];
      if (estimate::is_broken(trace, slip.peak_at, next.peak_at) || next.peak <= slip.trough) continue;
      mean.add(centre(slip, next.peak));
    }
    return std::tuple{mean.mean(), mean.count() < 1.0 ? 0.0 : mean.error_of_mean(), mean.count()};
  };
  const auto [first, first_error, first_count] = mean_from(0);
  const auto [last, last_error, last_count] = mean_from(cycles - third);
  if (std::min(first_count, last_count) < static_cast<double>(kFewestCycles) / 3.0) return std::nullopt;
  const boost::math::students_t of_errors{first_count + last_count - 2.0};
  const double limit = boost::math::quantile(boost::math::complement(of_errors, 0.5 * kLevel));
  if (!(std::abs(last - first) > limit * std::hypot(first_error, last_error))) return std::nullopt;
  return base::make_finding(base::FindingCode::kLevelDrift,
                            fmt::format("the level drifts along the track, from {:.4f} in the first third of "
                                        "the slips to {:.4f} in the last: "
                                        "S and K are "
                                        "means over this stretch",
                                        first, last),
                            {{"first_third", first, "1"}, {"last_third", last, "1"}});
}

detect::CycleShape cycle_shape(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips) {
  std::vector<double> ratios;
  signal::RunningVariance times;
  signal::RunningVariance sizes;
  double s_ts = 0.0;
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
    const detect::Fall slip = slips[i];
    const detect::Fall next = slips[i + 1];
    if (estimate::is_broken(trace, slip.peak_at, next.peak_at) || !(slip.drop() > 0.0)) continue;
    ratios.push_back((next.peak_at - slip.trough_at) / (slip.trough_at - slip.peak_at));
    const double time_s = estimate::time_at(trace, slip.peak_at);
    const double off_s = time_s - times.mean;
    const double size = std::log(slip.drop());
    times.add(time_s);
    sizes.add(size);
    s_ts += off_s * (size - sizes.mean);
  }
  detect::CycleShape shape{ratios.size(), 0.0, 0.0};
  if (ratios.size() <= 2) return shape;
  shape.rise_over_fall = signal::median(ratios);
  const double slope = s_ts / times.square_sum;
  const double left = std::max(sizes.square_sum - slope * s_ts, 0.0);
  const double variance = left / (static_cast<double>(ratios.size() - 2) * times.square_sum);
  shape.decay_sigmas = variance > 0.0 ? -slope / std::sqrt(variance) : 0.0;
  return shape;
}

void period_results(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                    TestResults& results) {
  if (slips.size() < 2) {
    const std::string reason = slips.empty() ? "no oscillation" : "one slip has no period";
    results.period_median = Estimate::none(reason);
    results.oscillation_frequency = Estimate::none(reason);
    return;
  }
  const std::size_t count = whole_cycles(trace, slips);
  if (count == 0) {
    results.period_median = results.oscillation_frequency =
        Estimate::none("no two slips without a gap or a hold between");
    return;
  }
  std::vector<std::size_t> first_slips;  // Of whole cycles, where some are broken.
  double broken_s = 0.0;
  const auto from_to = [&](std::size_t slip) {
    return estimate::time_at(trace, slips[slip + 1].peak_at) - estimate::time_at(trace, slips[slip].peak_at);
  };
  for (std::size_t i = 0; count + 1 < slips.size() && i + 1 < slips.size(); ++i) {
    if (!goes_on(trace, slips[i], slips[i + 1])) {
      broken_s += from_to(i);
    } else {
      first_slips.push_back(i);
    }
  }
  const auto period = [&](std::size_t i) { return from_to(first_slips.empty() ? i : first_slips[i]); };
  results.period_median = Estimate::of(signal::median_of(count, period));
  if (results.regime == model::Regime::kRingDown && results.omega.value) {
    results.oscillation_frequency =
        Estimate::of(*results.omega.value / (2.0 * std::numbers::pi),
                     results.omega.standard_error.value_or(std::nan("")) / (2.0 * std::numbers::pi));
    return;
  }
  const auto n = static_cast<double>(count);
  const double span_s = estimate::time_at(trace, slips.back().peak_at) -
                        estimate::time_at(trace, slips.front().peak_at) - broken_s;
  const double mean_s = span_s / n;
  // A late peak lengthens one period and shortens the next: the error of the mean takes the covariance
  // of neighbours into account, but never less than the two end points leave.
  double variance = 0.0;
  double neighbours = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double off = period(i) - mean_s;
    variance += off * off / n;
    if (i + 1 < count) neighbours += off * (period(i + 1) - mean_s) / n;
  }
  const double mean_variance = std::max(variance + 2.0 * neighbours, variance / n) / n;
  results.oscillation_frequency =
      n > 1.0 ? Estimate::of(1.0 / mean_s, std::sqrt(mean_variance) / (mean_s * mean_s))
              : Estimate::of(1.0 / mean_s);
}

}  // namespace stickslip::analysis
