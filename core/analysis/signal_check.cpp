#include "core/analysis/signal_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include "core/analysis/traditional.hpp"
#include "core/signal/noise.hpp"

namespace stickslip::analysis {
namespace {

/// A value that stands for more than this part of the loaded scans is frozen, also where it is the largest.
constexpr double kMostOfTheLoad = 0.5;

/// Noise of a scan in steps of the converter below which rounding is no white noise.
constexpr double kCoarseNoise = 0.25;
/// Three of five scans of noise are above half of this with a probability below 1e-26.
constexpr double kLargestSigmas = 12.0;

/// Results that need no height of the force; and those that need the times of its peaks besides.
constexpr std::string_view kOfTheScans[] = {"spike_count", "gap_count", "lost_scan_count",
                                            "scan_rate_measured"};
constexpr std::string_view kOfTheTimes[] = {"cycle_count", "period_median", "oscillation_frequency"};

std::size_t loaded_scans(const estimate::Trace& trace) {
  const double largest = estimate::largest_value(trace);
  return static_cast<std::size_t>(std::count_if(trace.value.begin(), trace.value.end(),
                                                [&](double value) { return value >= 0.5 * largest; }));
}

/// How high the trace begins, over its largest scan, if that is in mid-pull and no noise about zero.
std::optional<double> begin_under_load(const estimate::Trace& trace) {
  const double largest = estimate::largest_value(trace);
  if (!(largest > 0.0) || !begins_under_load(trace)) return std::nullopt;
  if (largest < kLargestSigmas * signal::scan_noise(trace.value, 0.0)) return std::nullopt;
  return trace.value.front() / largest;
}

/// Which of both it is where the frozen value is the highest.
void keep_one(const estimate::Trace& trace, SignalCheck& check) {
  if (!check.frozen || !check.clipped || !check.clipped->holds(check.frozen->lowest)) return;
  const double most = kMostOfTheLoad * static_cast<double>(loaded_scans(trace));
  if (static_cast<double>(check.frozen->longest) > most) {
    check.clipped.reset();
  } else {
    check.frozen.reset();
  }
}

std::string text_of(const NoPull& found) {
  if (found.is_brief) return fmt::format("the force was there for {:.2f} s", found.loaded_s);
  return fmt::format("the force jumped to {:.4f} within {} scans, and exceeded that by {:.1f} % at most",
                     found.level, kJumpScans, 100.0 * found.overshoot);
}

/// \pre check.voids()
std::string why_void(const SignalCheck& check) {
  if (check.no_pull) return "no pull: " + text_of(*check.no_pull);
  const auto& held = check.held();
  const double level = 0.5 * (held->lowest + held->highest);
  return check.frozen
             ? fmt::format("frozen: the force stood at {:.4f} for {} scans in a row", level, held->longest)
             : fmt::format("clipped: the force above {:.4f} is not known", level);
}

}  // namespace

SignalCheck check_signal(const estimate::Trace& trace, const base::LongColumn<double>& measured,
                         const base::LongColumn<std::uint8_t>& saturated, double step_coefficient,
                         double scan_rate_Hz) {
  const signal::LeftOut unusable = [&](std::size_t scan) { return trace.usable[scan] == 0; };
  SignalCheck check;
  const double step = step_coefficient > 0.0 ? step_coefficient : signal::smallest_step(measured);
  check.clipped = signal::flat_top(trace.value, unusable, step);
  check.frozen = signal::frozen_values(
      measured, [&](std::size_t scan) { return saturated[scan] != 0; }, step);
  keep_one(trace, check);
  const auto noise = signal::noise_in_steps(measured, unusable, step_coefficient, check.held());
  if (noise && *noise < kCoarseNoise) check.coarse_noise = noise;
  check.begins_at = begin_under_load(trace);
  check.no_pull = no_pull(trace, scan_rate_Hz);
  return check;
}

void void_results(const SignalCheck& check, TestResults& results) {
  if (!check.voids()) return;
  const std::string reason = why_void(check);
  for_each_result(results, [&](const ResultName& result, Estimate& estimate) {
    const bool stays = std::ranges::find(kOfTheScans, result.name) != std::end(kOfTheScans) ||
                       (check.clipped && !check.no_pull &&
                        std::ranges::find(kOfTheTimes, result.name) != std::end(kOfTheTimes));
    if (!stays) estimate = Estimate::none(reason);
  });
  results.regime = model::Regime::kUndecided;
  results.regime_reason = reason;
  results.rung = Rung::kNone;
  results.rung_reason = reason;
  results.misfit_place.clear();
  // They are of numbers that are not given.
  results.findings.clear();
}

void add_signal_findings(const SignalCheck& check, std::size_t scan_count, TestResults& results) {
  const auto number = [](auto count) { return static_cast<double>(count); };
  if (const auto& held = check.clipped) {
    base::add(
        results.findings,
        base::make_finding(
            base::FindingCode::kClipped,
            fmt::format("the force stood at its highest, {:.4f}, in {} of {} scans and {} stretches: the "
                        "amplifier clips, and neither regime nor coefficients are given",
                        held->highest, held->scan_count, scan_count, held->run_count),
            {{"highest", held->highest, "1"},
             {"clipped_count", number(held->scan_count), "1"},
             {"stretch_count", number(held->run_count), "1"},
             {"scan_count", number(scan_count), "1"}}));
  }
  if (const auto& held = check.frozen) {
    base::add(
        results.findings,
        base::make_finding(base::FindingCode::kFrozen,
                           fmt::format("the force stood at {:.4f} for {} scans in a row, from scan {} of {}: "
                                       "neither regime nor coefficients are given",
                                       held->lowest, held->longest, held->first, scan_count),
                           {{"level", held->lowest, "1"},
                            {"frozen_count", number(held->longest), "1"},
                            {"first_scan", number(held->first), "1"},
                            {"scan_count", number(scan_count), "1"}}));
  }
  if (const auto& found = check.no_pull) {
    base::add(results.findings,
              base::make_finding(base::FindingCode::kNoPull,
                                 text_of(*found) + ": no belt pulls a sled so, and neither regime nor "
                                                   "coefficients are given",
                                 {{"level", found->level, "1"},
                                  {"loaded_time", found->loaded_s, "s"},
                                  {"overshoot", found->overshoot, "1"}}));
  }
  if (const auto& noise = check.coarse_noise) {
    base::add(
        results.findings,
        base::make_finding(base::FindingCode::kCoarseSteps,
                           fmt::format("the noise of a scan is {:.2f} of a step of the converter, less than "
                                       "{}: standard errors do not hold",
                                       *noise, kCoarseNoise),
                           {{"noise", *noise, "1"}, {"limit", kCoarseNoise, "1"}}));
  }
  if (const auto& begin = check.begins_at) {
    base::add(
        results.findings,
        base::make_finding(base::FindingCode::kBeginsUnderLoad,
                           fmt::format("the trace begins at {:.2f} of its largest force, in mid-pull: static "
                                       "is not given",
                                       *begin),
                           {{"begin", *begin, "1"}}));
  }
}

}  // namespace stickslip::analysis
