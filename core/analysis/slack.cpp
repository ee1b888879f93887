#include "core/analysis/slack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/analysis/traditional.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// A trough is the lowest scan of a slack. One scan in 30 000 lies 4 σ above its level by chance, one in 10⁹
/// 6 σ below.
constexpr double kAboveSigmas = 4.0;
constexpr double kBelowSigmas = 6.0;

/// Median of the scans before the force first exceeds a quarter of its largest; 0 if there are too few, or
/// the trace begins under load.
double unloaded_level(const estimate::Trace& trace) {
  constexpr double kLoaded = 0.25;
  constexpr std::size_t kFewest = 5;
  constexpr std::size_t kMost = 4096;
  if (begins_under_load(trace)) return 0.0;
  const double limit = kLoaded * estimate::largest_value(trace);
  std::vector<double> before;
  for (std::size_t k = 0; k < trace.size() && before.size() < kMost && trace.value[k] < limit; ++k)
    before.push_back(trace.value[k]);
  return before.size() < kFewest ? 0.0 : signal::median(before);
}

}  // namespace

bool Slack::holds(const estimate::Trace& trace, const detect::Fall& slip) const noexcept {
  constexpr std::ptrdiff_t kBeside = 2;
  const auto at = static_cast<std::ptrdiff_t>(slip.trough_at);
  const auto size = static_cast<std::ptrdiff_t>(trace.size());
  double scan = std::numeric_limits<double>::infinity();
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(at - kBeside, 0); k < std::min(at + kBeside + 1, size);
       ++k)
    scan = std::min(scan, trace.value[static_cast<std::size_t>(k)]);
  return scan >= lowest && scan <= highest;
}

Slack find_slack(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips, double sigma) {
  if (slips.size() < 2) return {};
  const double unloaded = unloaded_level(trace);
  Slack slack{unloaded - kBelowSigmas * sigma, unloaded + kAboveSigmas * sigma, 0};
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) slack.count += slack.holds(trace, slips[i]) ? 1 : 0;
  return slack;
}

std::string why_slack(std::size_t slack_count, std::size_t slip_count) {
  return fmt::format(
      "the coupling hung slack after {} of {} slips: their troughs are those of the unloaded cell, and tell "
      "no K",
      slack_count, slip_count);
}

void void_slack_turns(const std::string& why, model::Regime regime, TestResults& results) {
  results.delta_mu = results.delta_mu_scatter = results.mu_k = Estimate::none(why);
  if (regime == model::Regime::kRingDown) results.mu_s = Estimate::none(why);
}

base::Finding slack_finding(std::size_t slack_count, std::size_t slip_count) {
  return base::make_finding(base::FindingCode::kSlack, why_slack(slack_count, slip_count),
                            {{"slack_count", static_cast<double>(slack_count), "1"},
                             {"slip_count", static_cast<double>(slip_count), "1"}});
}

}  // namespace stickslip::analysis
