#include "core/analysis/rest_groups.hpp"

#include <algorithm>
#include <iterator>

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
  signal::RunningVariance peak;
  signal::RunningVariance level;
  signal::RunningMean own_variance;  ///< Of S − K.
  signal::RunningMean speed;
  signal::RunningMean log_stick_time;

  void add(const RestedSlip& slip, const model::Oscillator& oscillator) {
    delta_mu.add(slip.delta_mu);
    peak.add(slip.peak);
    if (std::isfinite(slip.delta_mu))  // Else a slack coupling, or a test without K.
      level.add(detect::K_of_turning_points(slip.peak, slip.trough, oscillator));
    own_variance.add(slip.delta_mu_error * slip.delta_mu_error);
    speed.add(slip.pull_speed_m_per_s);
    log_stick_time.add(std::log(slip.stick_time_s));
  }
};

/// The groups of one speed. \param usual  its slips that follow no hold. \param all  of the whole test.
class GroupsOfSpeed {
 public:
  GroupsOfSpeed(const SlipMeans& usual, const SlipMeans& all, const TestResults& results)
      : usual_(usual), all_(all), results_(results) {
    if (results.mu_k.value && usual.level.count >= kFewestSlips)
      K_ = *results.mu_k.value + usual.level.mean - all.level.mean;
  }

  [[nodiscard]] RestGroup of_all() const {
    RestGroup group;
    group.pull_speed_m_per_s = usual_.speed.mean;
    group.stick_time_s = std::exp(usual_.log_stick_time.mean);
    group.K = K_;
    if (K_) group.K_error = std::sqrt(usual_.level.variance() / usual_.level.count);
    take_S(usual_.delta_mu.mean, usual_.peak.mean, usual_.peak.count, group);
    return group;
  }

  [[nodiscard]] RestGroup of(const RestedSlip& held) const {
    RestGroup group = of_all();
    group.held = true;
    group.stick_time_s = held.stick_time_s;
    take_S(held.delta_mu, held.peak, 1.0, group);
    return group;
  }

 private:
  void take_S(double delta_mu, double peak, double count, RestGroup& group) const {
    if (results_.rung == Rung::kTurningPoints) {
      const double as_mean = *results_.mu_s.value + peak - all_.peak.mean;
      group.S = K_ ? S_of_peak(peak) : as_mean;
      group.S_systematic = group.S - as_mean;  // The whole correction, as in all turning points.
      group.S_error = std::sqrt(usual_.peak.variance() / count);
      return;
    }
    group.S = *K_ + delta_mu;
    group.S_error = std::sqrt(usual_.delta_mu.variance() / count);
    // The errors of single slips hold the shared one and their own noise.
    const double share =
        usual_.delta_mu.mean > 0.0 ? std::sqrt(usual_.own_variance.mean) / usual_.delta_mu.mean : 0.0;
    group.S_systematic = share * (delta_mu - results_.delta_mu.value.value_or(usual_.delta_mu.mean));
  }

  /// For tests with a K. The force rises beyond S until the sled is as fast as the belt: the peak is
  /// K + √((S − K)² + u²), where u grows with the pull speed [Penner 1995, (1)]. The mean peak over the
  /// test's S tells u.
  [[nodiscard]] double S_of_peak(double peak) const {
    const auto square = [](double value) { return value * value; };
    const double K = *results_.mu_k.value;
    const double u_squared = std::max(square(all_.peak.mean - K) - square(*results_.mu_s.value - K), 0.0) *
                             square(usual_.speed.mean / all_.speed.mean);
    return *K_ + std::sqrt(std::max(square(peak - *K_) - u_squared, 0.0));
  }

  const SlipMeans& usual_;
  const SlipMeans& all_;
  const TestResults& results_;
  std::optional<double> K_;
};

}  // namespace

bool have_several_speeds(std::span<const RestedSlip> slips) {
  if (slips.empty()) return false;
  const auto [slowest, fastest] = std::ranges::minmax_element(slips, {}, &RestedSlip::pull_speed_m_per_s);
  return fastest->pull_speed_m_per_s > slowest->pull_speed_m_per_s * (1.0 + 2.0 * kSameSpeed);
}

std::vector<RestGroup> group_by_rest(std::span<const RestedSlip> slips, const TestResults& results) {
  const bool by_peaks = results.rung == Rung::kTurningPoints;
  if (!(by_peaks ? results.mu_s : results.mu_k).value) return {};
  // Of the oscillator the middles need the damping alone.
  const auto oscillator =
      model::Oscillator::from_omega(results.omega.value.value_or(1.0),
                                    results.gamma_over_2omega.value.value_or(model::kTypicalGammaOver2Omega));
  std::vector<RestedSlip> sorted;
  std::copy_if(slips.begin(), slips.end(), std::back_inserter(sorted), [&](const RestedSlip& slip) {
    return by_peaks || (std::isfinite(slip.delta_mu) && slip.delta_mu_error > 0.0);
  });
  std::stable_sort(sorted.begin(), sorted.end(), [](const RestedSlip& one, const RestedSlip& other) {
    return one.pull_speed_m_per_s < other.pull_speed_m_per_s;
  });
  // The same that make the test's S and K: slack ones only where it has no K.
  SlipMeans all;
  for (const RestedSlip& slip : sorted) {
    if (!slip.held && (!results.mu_k.value || std::isfinite(slip.delta_mu))) all.add(slip, oscillator);
  }
  std::vector<RestGroup> groups;
  for (auto first = sorted.begin(); first != sorted.end();) {
    auto end = first + 1;
    while (end != sorted.end() &&
           end->pull_speed_m_per_s <= (end - 1)->pull_speed_m_per_s * (1.0 + kSameSpeed))
      ++end;
    const bool is_one_speed =
        (end - 1)->pull_speed_m_per_s <= first->pull_speed_m_per_s * (1.0 + 2.0 * kSameSpeed);
    const auto held = std::stable_partition(first, end, [](const RestedSlip& slip) { return !slip.held; });
    if (is_one_speed && static_cast<std::size_t>(held - first) >= kFewestSlips) {
      SlipMeans usual;
      for (auto slip = first; slip != held; ++slip) usual.add(*slip, oscillator);
      const GroupsOfSpeed own{usual, all, results};
      groups.push_back(own.of_all());
      for (auto slip = held; slip != end; ++slip) groups.push_back(own.of(*slip));
    }
    first = end;
  }
  return groups;
}

}  // namespace stickslip::analysis
