#include "core/analysis/slack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/analysis/slip_guess.hpp"
#include "core/analysis/traditional.hpp"

namespace stickslip::analysis {
namespace {

/// By chance one scan in 30 000 of an unloaded cell lies higher.
constexpr double kSlackSigmas = 4.0;

/// Mean of the last two steps of the fall before scan `first`, 1/s.
double fall_rate(const estimate::Trace& trace, std::size_t peak, std::size_t first) {
  const base::LongColumn<double>& values = trace.value;
  const base::LongColumn<double>& times_s = trace.time_s;
  const std::size_t last = first - 1;
  const std::size_t from = std::max(peak, last < 2 ? 0 : last - 2);
  // Without a step above the level the force fell by more than any belt takes up in one.
  if (from >= last) return std::numeric_limits<double>::infinity();
  return (values[from] - values[last]) / (times_s[last] - times_s[from]);
}

}  // namespace

void find_slack(const base::LongColumn<detect::Fall>& slips, double sigma, estimate::Trace& trace,
                const std::filesystem::path& scratch) {
  if (slips.size() < 2) return;
  const base::LongColumn<double>& values = trace.value;
  const detect::Fall first_slip = slips[0];
  const double unloaded = begins_under_load(trace) ? 0.0 : level_before(trace, first_slip);
  const double highest = unloaded + kSlackSigmas * sigma;
  // A column in a file can be read but not changed.
  base::LongColumn<std::uint8_t> usable{scratch};
  const auto copy_up_to = [&](std::size_t end) {
    while (usable.size() < end) usable.push_back(std::as_const(trace.usable)[usable.size()]);
  };
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
    const detect::Fall slip = slips[i];
    if (slip.trough > highest) continue;
    const detect::Fall next = slips[i + 1];
    const std::size_t peak = scan_at(slip.peak_at);
    std::size_t first = 0;
    for (std::size_t k = peak + 1; k < scan_at(next.peak_at); ++k) {
      if (values[k] > highest) continue;
      if (first == 0) first = k;
      copy_up_to(k);
      usable.push_back(0);
    }
    if (first == 0) continue;
    const double taken_up = slope_of_sticks(trace, std::array{next});
    trace.slacks.push_back({first, fall_rate(trace, peak, first) > taken_up});
  }
  if (trace.slacks.empty()) return;
  copy_up_to(trace.size());
  trace.usable = std::move(usable);
}

std::optional<base::Finding> slack_finding(const estimate::Trace& trace, std::size_t slip_count) {
  if (trace.slacks.empty()) return std::nullopt;
  return base::make_finding(
      base::FindingCode::kSlack,
      fmt::format(
          "the coupling hung slack after {} of {} slips: of these only the fall up to it tells S and K",
          trace.slacks.size(), slip_count),
      {{"slack_count", static_cast<double>(trace.slacks.size()), "1"},
       {"slip_count", static_cast<double>(slip_count), "1"}});
}

void void_slack_turns(const estimate::Trace& trace, model::Regime regime, TestResults& results) {
  if (trace.slacks.empty()) return;
  const Estimate none = Estimate::none(
      "the coupling hung slack: the troughs are those of a loose coupling, and tell no K by turning points");
  results.delta_mu = none;
  // A free oscillation has its K in the slips without slack, and its only S in the first.
  (regime == model::Regime::kRingDown ? results.mu_s : results.mu_k) = none;
}

}  // namespace stickslip::analysis
