#include "core/analysis/rest_groups.hpp"

#include <algorithm>

#include "core/analysis/grouping.hpp"
#include "core/detect/turning_points.hpp"
#include "core/model/oscillator.hpp"
#include "core/model/tester.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// At one speed, for their scatter to be known.
constexpr std::size_t kFewestSlips = 4;

/// Means over the slips of one speed that follow no hold.
struct SlipMeans {
  signal::RunningVariance delta_mu;
  signal::RunningVariance level;
  signal::RunningMean own_variance;  ///< Of S − K.
  signal::RunningMean speed;
  signal::RunningMean log_stick_time;
};

SlipMeans means_of(std::span<const RestedSlip> slips, const model::Oscillator& oscillator) {
  SlipMeans group;
  for (const RestedSlip& slip : slips) {
    group.delta_mu.add(slip.delta_mu);
    group.level.add(detect::K_of_turning_points(slip.peak, slip.trough, oscillator));
    group.own_variance.add(slip.delta_mu_error * slip.delta_mu_error);
    group.speed.add(slip.pull_speed_m_per_s);
    group.log_stick_time.add(std::log(slip.stick_time_s));
  }
  return group;
}

void add_groups(const SlipMeans& usual, std::span<const RestedSlip> held, std::vector<RestGroup>& groups) {
  RestGroup group;
  group.pull_speed_m_per_s = usual.speed.mean;
  group.stick_time_s = std::exp(usual.log_stick_time.mean);
  group.delta_mu = usual.delta_mu.mean;
  group.delta_mu_error = std::sqrt(usual.delta_mu.variance() / usual.delta_mu.count);
  // The errors of single slips hold the shared one and their own noise.
  if (usual.delta_mu.mean > 0.0) group.shared_part = std::sqrt(usual.own_variance.mean) / usual.delta_mu.mean;
  group.K = usual.level.mean;
  group.K_error = std::sqrt(usual.level.variance() / usual.level.count);
  groups.push_back(group);
  group.held = true;
  for (const RestedSlip& slip : held) {
    group.stick_time_s = slip.stick_time_s;
    group.delta_mu = slip.delta_mu;
    group.delta_mu_error = std::sqrt(usual.delta_mu.variance());
    groups.push_back(group);
  }
}

}  // namespace

std::vector<RestGroup> group_by_rest(std::span<const RestedSlip> slips, const TestResults& results) {
  std::vector<RestGroup> groups;
  if (!results.mu_k.value) return groups;
  // Of the oscillator the middles need the damping alone.
  const auto oscillator =
      model::Oscillator::from_omega(results.omega.value.value_or(1.0),
                                    results.gamma_over_2omega.value.value_or(model::kTypicalGammaOver2Omega));
  std::vector<RestedSlip> sorted{slips.begin(), slips.end()};
  std::stable_sort(sorted.begin(), sorted.end(), [](const RestedSlip& one, const RestedSlip& other) {
    return one.pull_speed_m_per_s < other.pull_speed_m_per_s;
  });
  signal::RunningMean level;  // Of the slips whose K the test has.
  for (auto first = sorted.begin(); first != sorted.end();) {
    auto end = first + 1;
    while (end != sorted.end() &&
           end->pull_speed_m_per_s <= (end - 1)->pull_speed_m_per_s * (1.0 + kSameSpeed))
      ++end;
    const bool is_one_speed =
        (end - 1)->pull_speed_m_per_s <= first->pull_speed_m_per_s * (1.0 + 2.0 * kSameSpeed);
    const auto held = std::stable_partition(first, end, [](const RestedSlip& slip) { return !slip.held; });
    const SlipMeans usual = means_of({first, held}, oscillator);
    for (auto slip = first; slip != held; ++slip)
      level.add(detect::K_of_turning_points(slip->peak, slip->trough, oscillator));
    if (is_one_speed && static_cast<std::size_t>(held - first) >= kFewestSlips)
      add_groups(usual, {held, end}, groups);
    first = end;
  }
  for (RestGroup& group : groups) group.K += *results.mu_k.value - level.mean;
  return groups;
}

}  // namespace stickslip::analysis
