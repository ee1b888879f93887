/// \file
/// Detection of values that repeat more often than the noise of a scan lets them: a flat top, where an
/// amplifier clips, and a frozen value. Also the noise in steps of the converter.
///
///     if (const auto top = flat_top(values, left_out, step)) …
///
/// The noise is taken as white on single scans, of standard deviation σ; the signal beneath it may be
/// anything. A scan then lies in a band of width w with probability p ≤ erf(w/(2√2 σ)), as no level of the
/// signal makes a band more likely than the level in its middle. σ is that of the quietest stretch outside
/// the band (of a flat top the band of two steps, of a frozen value its stretch), less a margin and the noise
/// of rounding: noise that comes with a motor is not taken for a fault.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "core/base/long_column.hpp"

namespace stickslip::signal {

/// Largest probability of finding a flat top, and of finding a frozen value, in a test without that fault.
inline constexpr double kFalseAlarm = 1e-6;

/// Whether a scan is left out: at a rail of the converter, and, except for frozen_values(), a spike. Must be
/// set.
/// \param scan  index of its value.
using LeftOut = std::function<bool(std::size_t scan)>;

/// Scans of equal or nearly equal values.
struct HeldValues {
  double lowest = 0.0;   ///< Lower end of the band of values.
  double highest = 0.0;  ///< Upper end.
  /// Scans in the band; of a frozen value those of the longest stretch alone.
  std::size_t scan_count = 0;
  /// Stretches of consecutive scans in the band, which a scan left out ends; 1 for a frozen value.
  std::size_t run_count = 0;
  std::size_t first = 0;    ///< Index of the first value of the longest stretch.
  std::size_t longest = 0;  ///< Number of scans in it.

  [[nodiscard]] bool holds(double value) const noexcept { return value >= lowest && value <= highest; }
};

/// Finds the highest level of the trace if scans stay there more often than noise lets them. T scans in a
/// band below the largest value have a scan behind them that is not left out; C of those are in the band.
/// Noise alone does so with probability exp(−T·KL(C/T, p)) at most [Chernoff 1952]. Multiplied by N² (any of
/// N scans may be the largest, and T any number up to N) and by the five bands, this must not exceed
/// kFalseAlarm. The bands are equal values, two steps, σ/4, σ and 2 σ; the result is the one that passes with
/// the most scans. A clipped signal that gets as much noise behind the amplifier as before it is not told
/// from a sound one.
/// \param step  of the converter, or the smallest difference of neighbours as measured.
/// \return nullopt if there is none; also unless the largest value and the step are positive, if there are no
/// 68 consecutive scans outside the band of two steps, and if the quietest of such 68 show no noise clearly
/// above that of rounding.
[[nodiscard]] std::optional<HeldValues> flat_top(const base::LongColumn<double>& values,
                                                 const LeftOut& left_out, double step);

/// Finds the longest run of equal values if noise does not let it be so long: n in a row happen among N scans
/// with probability N n p^(n − 1) at most, which must not exceed kFalseAlarm. Only values of at least a third
/// of the largest count, since an unloaded cell may be quieter than a pull.
/// \param step  as for flat_top().
/// \return nullopt if there is none of at least 16 scans; also for the reasons that flat_top() has, but with
/// the noise of the scans outside the run.
[[nodiscard]] std::optional<HeldValues> frozen_values(const base::LongColumn<double>& values,
                                                      const LeftOut& left_out, double step);

/// White noise of a scan, as a standard deviation in steps of the converter; the variance of rounding, 1/12,
/// is subtracted first, and the result is 0 if no more is left. From the values of at least a third of the
/// largest. Half a step reads below a quarter with a probability < 1e-6.
/// \param step  of the converter; ≤ 0 if unknown. It is then the smallest non-zero difference of neighbours,
/// if all their differences are multiples of that and at least a tenth of them is zero.
/// \param held  values to leave out; nullopt: none.
/// \return nullopt if there are fewer than eight blocks of 64 fourth differences, if no value is positive, or
/// if the step stays unknown.
[[nodiscard]] std::optional<double> noise_in_steps(const base::LongColumn<double>& values,
                                                   const LeftOut& left_out, double step,
                                                   const std::optional<HeldValues>& held);

}  // namespace stickslip::signal
