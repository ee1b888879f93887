#include "core/analysis/slack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/analysis/traditional.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// By chance one scan in 30 000 of an unloaded cell lies higher.
constexpr double kSlackSigmas = 4.0;

/// Median of the scans before the force first exceeds a quarter of its largest; 0 if there are too few, or
/// the trace begins under load.
double unloaded_level(const estimate::Trace& trace) {
  constexpr double kLoaded = 0.25;
  constexpr std::size_t kFewest = 5;
  constexpr std::size_t kMost = 4096;
  if (begins_under_load(trace)) return 0.0;
  const double limit = kLoaded * *std::max_element(trace.value.begin(), trace.value.end());
  std::vector<double> before;
  for (std::size_t k = 0; k < trace.size() && before.size() < kMost && trace.value[k] < limit; ++k)
    before.push_back(trace.value[k]);
  return before.size() < kFewest ? 0.0 : signal::median(before);
}

}  // namespace

std::size_t count_slack(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                        double sigma) {
  if (slips.size() < 2) return 0;
  const double highest = unloaded_level(trace) + kSlackSigmas * sigma;
  std::size_t count = 0;
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) count += slips[i].trough <= highest ? 1 : 0;
  return count;
}

std::string why_slack(std::size_t slack_count, std::size_t slip_count) {
  return fmt::format(
      "the coupling hung slack after {} of {} slips: their troughs are those of the unloaded cell, and tell "
      "no K",
      slack_count, slip_count);
}

void void_slack_turns(const std::string& why, model::Regime regime, TestResults& results) {
  results.delta_mu = results.delta_mu_scatter = Estimate::none(why);
  (regime == model::Regime::kRingDown ? results.mu_s : results.mu_k) = Estimate::none(why);
}

base::Finding slack_finding(std::size_t slack_count, std::size_t slip_count) {
  return base::make_finding(base::FindingCode::kSlack, why_slack(slack_count, slip_count),
                            {{"slack_count", static_cast<double>(slack_count), "1"},
                             {"slip_count", static_cast<double>(slip_count), "1"}});
}

}  // namespace stickslip::analysis
