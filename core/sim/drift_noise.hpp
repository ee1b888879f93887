/// \file
/// 1/f noise as a sum of Ornstein–Uhlenbeck processes whose corner frequencies are evenly spaced on a
/// logarithmic axis and whose variances are equal. [Milotti, "1/f noise: a pedagogical review",
/// arXiv:physics/0204033, 2002; each step exact: Gillespie, Phys. Rev. E 54(2):2084–2091, 1996]
///
/// With two processes a decade, f · S(f) ripples by 4/(e^x + e^−x), x = π²/ln √10 = 8.57: 0.08 % (Poisson
/// summation of 1/cosh; one a decade would give 5.5 %). It falls to a half at the lowest and highest
/// frequency and is flat to 7 % one decade inside of them.
#pragma once

#include <vector>

#include "core/sim/signal_settings.hpp"

namespace stickslip::sim {

/// One of the processes: x ← decay · x + step · (a standard normal number), once a scan.
struct DriftProcess {
  double decay = 0.0;  ///< e^(−2π f/scan rate), f the corner frequency
  double step_V = 0.0;
  double value_V = 0.0;
};

/// The processes of a drift, with value zero, from the lowest corner frequency to the highest. Each has the
/// standard deviation sd_V/√(their number). \param scan_rate_Hz  true.
[[nodiscard]] std::vector<DriftProcess> drift_processes(const DriftNoise& settings, double scan_rate_Hz);

/// One-sided density of the sampled drift, V²/Hz, aliases included; 0 ≤ frequency ≤ half the rate.
[[nodiscard]] double drift_density(const DriftNoise& settings, double scan_rate_Hz, double frequency_Hz);

}  // namespace stickslip::sim
