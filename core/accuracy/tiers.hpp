/// \file
/// Error and computing time of live S − K per cycle: each estimator tier at several scan rates, relative to
/// the Cramér–Rao bound.
///
///     for (const TierRow& row : compare_tiers(*clock, peer)) …
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"

namespace stickslip::accuracy {

/// Description of the simulated scene.
inline constexpr std::string_view kTierScene =
    "S 0.35, K 0.30, 20 Hz, γ/2ω 0.022 characterised, 12 in/min, noise 0.001 rms; bound: the least sd of one "
    "cycle "
    "with ω, γ and the stick rate known";

/// One row: an estimator at one scan rate.
struct TierRow {
  double scan_rate_Hz = 0.0;
  double scans_per_cycle = 0.0;  ///< Of the oscillation.
  std::string estimator;
  std::string reason;         ///< Why there are no numbers; empty if there are.
  double bias = 0.0;          ///< Mean of (S − K found)/(true S − K) − 1.
  double deviation = 0.0;     ///< Standard deviation of (S − K found)/(true S − K).
  double over_bound = 0.0;    ///< deviation over the relative Cramér–Rao bound of a cycle.
  double us_per_cycle = 0.0;  ///< Computing time of a whole test over its cycles.
};

/// Input of all estimators at one scan rate: the force of several tests.
struct TierScene {
  double scan_rate_Hz = 0.0;
  double frequency_Hz = 0.0;               ///< Of the oscillation.
  std::vector<std::vector<double>> tests;  ///< Coefficients, scan by scan.
};

/// Result of an external program for one scene; it gets whole tests and measures its own time.
struct PeerOutcome {
  double ns_per_scan = 0.0;       ///< Of the first test.
  std::vector<double> estimates;  ///< S − K of the cycles found in all tests, without the first of each test.
};

/// An external program to compare with.
struct Peer {
  std::string name;
  /// Returns an outcome for each scene, in their order; or an error, which is the reason in all its rows.
  std::function<base::Result<std::vector<PeerOutcome>>(std::span<const TierScene>)> run;
};

/// The raw maximum less the mean, a peer, and the tiers of detect::LiveDetector, at 50 … 10 000 scans/s.
/// A rate that estimate::check_sampling() refuses has one row, "all", with the reason; these rows come first.
/// The others follow rate by rate, the estimators in the order above. The numbers are the same in each run,
/// but for the times.
[[nodiscard]] std::vector<TierRow> compare_tiers(const base::Clock& clock, const Peer& peer);

}  // namespace stickslip::accuracy
