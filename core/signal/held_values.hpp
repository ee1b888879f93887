/// \file
/// Values that repeat more often than the noise of a scan lets them: a flat top, where an amplifier clips,
/// and a frozen value. And the noise in steps of the converter.
///
///     if (const auto top = flat_top(values, left_out, step)) …
///
/// Noise: white on single scans, of standard deviation σ; beneath it the signal may be anything. Two scans in
/// a row then lie in the same band of width w with probability p ≤ erf(w/(2√2 σ)), as no level of the signal
/// makes a band more likely than the level in its middle. σ is that of the quietest stretch elsewhere, so
/// that a bench whose noise comes with its motor is not taken for a fault, and less the noise of rounding.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "core/base/long_column.hpp"

namespace stickslip::signal {

/// Largest probability that a test without a fault has one of these findings.
inline constexpr double kFalseAlarm = 1e-6;

/// Whether a scan is left out: a spike, or at a rail of the converter.
using LeftOut = std::function<bool(std::size_t scan)>;

/// Scans that are equal, or nearly so.
struct HeldValues {
  double lowest = 0.0;
  double highest = 0.0;
  std::size_t scan_count = 0;
  std::size_t run_count = 0;  ///< Stretches of scans without another value between them.
  std::size_t first = 0;      ///< Scan at which the longest stretch begins.
  std::size_t longest = 0;    ///< Its scans.

  [[nodiscard]] bool holds(double value) const noexcept { return value >= lowest && value <= highest; }
};

/// The highest level of the trace if scans stay there more often than noise lets them. Of T scans in a band
/// below the largest, C are followed by another one; noise alone does so with probability exp(−T·KL(C/T, p))
/// at most [Chernoff 1952], for each of as many largest values and counts T as there are scans, and for five
/// bands: equal values, two steps, σ/4, σ and 2 σ. A clipped signal that gets as much noise behind the
/// amplifier as before it is not told from a sound one.
/// \param step  of the converter, or the smallest difference of neighbours as measured; nothing is found
/// unless it is positive.
[[nodiscard]] std::optional<HeldValues> flat_top(const base::LongColumn<double>& values,
                                                 const LeftOut& left_out, double step);

/// The longest run of equal values above a third of the largest, if noise does not let it be so long: n in a
/// row happen among N scans with probability N n p^(n − 1) at most. An unloaded cell may be quieter than a
/// pull.
[[nodiscard]] std::optional<HeldValues> frozen_values(const base::LongColumn<double>& values,
                                                      const LeftOut& left_out, double step);

/// White noise of a scan in steps of the converter, less that of rounding, where the force is above a third
/// of the largest; nullopt if fewer than eight blocks of scans tell it, or if no converter is seen. Noise of
/// half a step reads below a quarter with a probability of 1e-6: half of the blocks would have to be off by
/// three standard deviations.
/// \param held  scans to leave out; nullopt: none.
[[nodiscard]] std::optional<double> noise_in_steps(const base::LongColumn<double>& values,
                                                   const LeftOut& left_out, double step,
                                                   const std::optional<HeldValues>& held);

}  // namespace stickslip::signal
