/// \file
/// Removes electrical spikes of single scans and two in a row [Penner 1995: "sharp electrical spikes … which
/// have to be removed as they would lead to a false peak"].
///
///     Despiker despiker;
///     if (auto scan = despiker.add(value, sigma)) use(scan->value, scan->spike);
///     while (auto scan = despiker.flush(sigma)) use(scan->value, scan->spike);
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/signal/sliding_window.hpp"

namespace stickslip::signal {

/// A scan as the filter returns it; scans come in the order of the input.
struct DespikedScan {
  double value = 0.0;  ///< As measured; of a spike the replacement: the cubic through its neighbours, or the
                       ///< median of it and its neighbours.
  bool spike = false;
};

/// Filter that replaces spikes. It has two tests; a scan that either of them finds is a spike.
///
/// Hampel identifier over five scans [Hampel, J. Am. Stat. Assoc. 69 (1974) 383]: a scan is a
/// spike if it is farther from the median of itself and two neighbours on each side than three
/// scaled median absolute deviations and than five standard deviations of the scan noise. The first limit
/// protects curved parts of the trace (at a peak the five differ by more than the noise), the second flat
/// ones. The test finds spikes on a flat trace, up to two in a row. On the slope of an oscillation the five
/// differ so much that it misses a spike as large as the amplitude.
///
/// Outlier of a cubic over seven scans, three on each side, for spikes on slopes: at 17.5 scans a cycle a
/// cubic leaves 0.4 % of the amplitude. One scan, or two from the middle on, are outliers if the cubic fits
/// the others best, each exceeds five standard deviations, and they explain nearly all of the misfit.
/// Corners, steps and oscillations with at least 5 scans a cycle fail the last condition (with fewer, the
/// estimated noise is that of the oscillation). Scans before the middle enter repaired.
///
/// The delay is three scans. The three scans at each end are tested by the first test only, the outer two
/// with the neighbours that they have; a trace of fewer than three is not tested. Does not allocate.
class Despiker {
 public:
  /// Takes the next scan. \param sigma  standard deviation of the noise of one scan (NoiseEstimator).
  /// \return the scan three before it; nullopt for the first three.
  [[nodiscard]] std::optional<DespikedScan> add(double value, double sigma) noexcept {
    window_.push(value);
    if (size_ == kWidth) return judge_middle(sigma);
    return begin(sigma);
  }
  /// Returns the remaining scans, one per call; then nullopt, and the filter is empty.
  [[nodiscard]] std::optional<DespikedScan> flush(double sigma) noexcept;

 private:
  static constexpr std::size_t kWidth = 7;
  static constexpr std::size_t kDelay = 3;

  /// While the window fills.
  [[nodiscard]] std::optional<DespikedScan> begin(double sigma) noexcept;
  /// With three on each side.
  [[nodiscard]] DespikedScan judge_middle(double sigma) noexcept;
  /// At the ends of the trace.
  [[nodiscard]] DespikedScan judge_end(std::size_t position, double sigma) noexcept;

  SlidingWindow<kWidth> window_;  ///< The newest `size_` are in use; judged ones repaired.
  std::size_t size_ = 0;
  std::size_t judged_ = 0;  ///< Leading scans of the window that were returned already.
};

}  // namespace stickslip::signal
