/// \file
/// Natural oscillation of a load cell, from taps on it while it carries nothing.
///
///     const Taps taps = find_taps(values, 2000.0);
///     const auto pooled = pool_ring_downs(rings);   // of all taps
///     const CellEstimate cell = cell_of(pooled->coupling);
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/analysis/characterisation.hpp"
#include "core/analysis/results.hpp"

namespace stickslip::analysis {

/// Free oscillation of the cell after one tap.
struct Tap {
  double at_s = 0.0;    ///< Time of the reading farthest from the level, after the first of the values.
  TesterEstimate ring;  ///< ω and γ/2ω of the cell; v/g is 0.
};

struct RefusedTap {
  double at_s = 0.0;  ///< As Tap::at_s.
  std::string why;    ///< With what to do instead.
};

struct Taps {
  std::vector<Tap> taps;
  std::vector<RefusedTap> refused;  ///< Taps that tell nothing of the cell.
};

/// Finds the taps in equally spaced readings, and fits one decaying oscillation about a level to what follows
/// each. The fit begins after the tap, once its residuals are noise. Taps with no more than 0.15 s of quiet
/// between them are one. From 8000 readings a second on neighbours are averaged, to 4000 a second at least.
/// \param readings  in any unit; finite; without gaps.
/// \param scan_rate_Hz > 0. A cell above half of it seems to oscillate at another frequency below
///        (alias_Hz()).
/// \return no tap if no reading is off the level, to either side, by more than twelve standard deviations of
///        the noise, or if there are fewer than twelve readings. The level follows a drift before the tap.
[[nodiscard]] Taps find_taps(std::span<const double> readings, double scan_rate_Hz);

/// What a load cell is, in the terms of model::LoadCellDynamics.
struct CellEstimate {
  Estimate frequency_Hz;   ///< Natural, without damping: ω √(1 + (γ/2ω)²)/2π.
  Estimate damping_ratio;  ///< ζ
};
/// \param coupling  ω and γ/2ω of the cell with their covariance.
[[nodiscard]] CellEstimate cell_of(const estimate::SharedPrior::Coupling& coupling);

/// The lowest frequency above half the scan rate whose readings are those of `frequency_Hz`.
/// \param frequency_Hz  at most half the scan rate.
[[nodiscard]] constexpr double alias_Hz(double frequency_Hz, double scan_rate_Hz) noexcept {
  return scan_rate_Hz - frequency_Hz;
}

}  // namespace stickslip::analysis
