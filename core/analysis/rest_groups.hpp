/// \file
/// Slips of a test whose belt changed its speed or stood still, in groups of one speed or one hold: what such
/// a test says about the friction law.
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
  double peak = 0.0;            ///< Coefficient, as Cycle::peak.
  double trough = 0.0;          ///< Coefficient, as Cycle::trough.
  bool held = false;            ///< The belt stood still before it.
};

/// The slips at one speed that follow no hold; or a single slip after a hold.
struct RestGroup {
  double pull_speed_m_per_s = 0.0;  ///< Mean over the slips at this speed that follow no hold.
  double stick_time_s = 0.0;        ///< Geometric mean.
  double S = 0.0;                   ///< Mean.
  /// Standard error of S by the scatter from slip to slip; of a single slip that scatter.
  double S_error = 0.0;
  /// Systematic part of S beyond that of the test's S; its sign tells the direction. By a fit: ω, γ and stick
  /// rate make each S − K off by the same share. By turning points: by how much less the peak exceeds S here
  /// than the mean peak exceeds the test's S.
  double S_systematic = 0.0;
  /// Mean over the slips at this speed that follow no hold. Absent if the test has no K, or if fewer than
  /// four of these slips have an S − K, as where the coupling went slack.
  std::optional<double> K;
  double K_error = 0.0;  ///< Standard error of K without that of the test's K, which all groups share.
  bool held = false;     ///< A single slip after a hold.
};

/// The slips whose pull speed and stick time are known, in the order of the cycles.
/// \param cycles  rows of TestAnalysis::cycles(), by index. They hold pull speeds only where the speed
/// changed or was measured.
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

/// Whether the fastest pull is faster than the slowest by more than 2 %, twice kSameSpeed.
[[nodiscard]] bool have_several_speeds(std::span<const RestedSlip> slips);

/// Groups slips by their pull speed; each slip after a hold is a group of its own, since it has its own place
/// on the paper and its own time at rest.
///
/// Neighbouring speeds within kSameSpeed, 1 %, are one speed. Speeds that spread over more than twice that,
/// as on a ramp, make no group. At one speed four slips that follow no hold are needed; with fewer, its slips
/// after holds are left out, too.
///
/// K of a speed is the test's K plus what the K by turning points of these slips is on average above that of
/// all slips that follow no hold. It takes the damping of the results, or the typical one.
///
/// S by a fit is that K plus the mean S − K of the slips; slips without S − K or its error are left out. S by
/// turning points comes from the peak alone, since a trough may be that of a slack coupling: the peak is
/// K + √((S − K)² + u²), u proportional to the pull speed and such that the mean peak gives the test's S.
/// Without a K each peak exceeds S by as much as the mean peak exceeds the test's S.
///
/// \param results  of the test.
/// \return in the order of rising speed; empty if the results have no S by turning points, or no K by a fit.
[[nodiscard]] std::vector<RestGroup> group_by_rest(std::span<const RestedSlip> slips,
                                                   const TestResults& results);

}  // namespace stickslip::analysis
