/// \file
/// Slips of a test whose belt changed its speed, grouped by how long the contact rested before them: what
/// such a test says about the friction law.
///
///     for (const RestGroup& group : group_by_rest(rested_slips(cycles), results)) …
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/detect/cycle.hpp"

namespace stickslip::analysis {

/// A slip that began from a stick of known duration, at a known pull speed.
struct RestedSlip {
  double pull_speed_m_per_s = 0.0;
  double stick_time_s = 0.0;
  double delta_mu = 0.0;        ///< NaN if not estimated.
  double delta_mu_error = 0.0;  ///< NaN without a fit.
  double peak = 0.0;
  double trough = 0.0;
  bool held = false;  ///< The belt stood still before it.
};

struct RestGroup {
  double pull_speed_m_per_s = 0.0;  ///< Mean.
  double stick_time_s = 0.0;        ///< Geometric mean.
  double S = 0.0;                   ///< Mean.
  /// Of that mean by the scatter from slip to slip; of a single slip that scatter.
  double S_error = 0.0;
  /// Systematic part of S beyond that of the test's. Of a fit: omega, gamma and stick rate make each S − K
  /// off by the same share. By turning points: by how much less it overshoots than the mean peak.
  double S_systematic = 0.0;
  std::optional<double>
      K;  ///< Mean of the slips at this speed that follow no hold; absent if the test has none.
  double K_error = 0.0;  ///< Of that mean against those of other speeds.
  bool held = false;     ///< A single slip after a hold.
};

/// \param cycles  of a test whose belt changed its speed: others do not know the speed of each slip.
template <typename Cycles>
[[nodiscard]] std::vector<RestedSlip> rested_slips(const Cycles& cycles) {
  std::vector<RestedSlip> slips;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const detect::Cycle& cycle = cycles[i];
    if (!(cycle.pull_speed_m_per_s > 0.0) || !(cycle.stick_time_s > 0.0)) continue;
    slips.push_back({cycle.pull_speed_m_per_s, cycle.stick_time_s, cycle.delta_mu,
                     cycle.delta_mu_standard_error, cycle.peak, cycle.trough,
                     (cycle.flags & detect::kCycleIsFirst) != 0});
  }
  return slips;
}

/// Whether the fastest pull is faster than the slowest by more than twice kSameSpeed.
[[nodiscard]] bool have_several_speeds(std::span<const RestedSlip> slips);

/// Each slip after a hold is a group of its own: it has its place on the paper and its time at rest. The
/// others are grouped by their speed: speeds that follow each other within kSameSpeed are one, unless they
/// spread over more than twice that, as on a ramp; fewer than four slips make no group, and fewer than four
/// of which none was slack no K. Slips after a hold at a speed without a group are left out. K of a speed is
/// the test's K and by how much the middles of the falls at this speed lie off the mean of all; without a
/// damping the typical one is taken. S is K and the fitted S − K of the slips. By turning points it comes
/// from the peaks, which overshoot it as the mean peak overshoots the test's S: a trough may be that of a
/// slack coupling. Without a K all overshoot alike. \param results  of the test. \return empty where they
/// have no S, and no K though they are fitted.
[[nodiscard]] std::vector<RestGroup> group_by_rest(std::span<const RestedSlip> slips,
                                                   const TestResults& results);

}  // namespace stickslip::analysis
