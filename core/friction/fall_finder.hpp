/// \file
/// Turning points of a noisy force: rises and falls that are large against the noise of a scan.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/scan_index.hpp"

namespace stickslip::friction {

/// A fall of the force between two turning points. Times are in scans after the first scan.
struct Fall {
  double peak_at = 0.0;        ///< Position of the maximum, interpolated between scans.
  double trough_at = 0.0;      ///< Position of the following minimum, interpolated.
  double peak = 0.0;           ///< Value at the maximum, interpolated.
  double trough = 0.0;         ///< Value at the minimum, interpolated.
  double duration = 0.0;       ///< Scans from the last above 90 % to the first below 10 % of the drop.
  double rise_duration = 0.0;  ///< Scans from the turning point before to the peak.
  double rise_from = 0.0;      ///< Value at that turning point.

  double robust_drop = 0.0;  ///< Drop of the median of three, on which noise hardly counts.

  [[nodiscard]] double drop() const noexcept { return peak - trough; }
};

/// Follows the force with hysteresis: a maximum is one as soon as the force has fallen below it by
/// the hysteresis, a minimum likewise. Runs on the median of three scans, so that no single scan
/// makes a turning point; the values reported come from the scans themselves.
class FallFinder {
 public:
  /// \param value       despiked coefficient of the next scan.
  /// \param hysteresis  > 0; the caller scales it to the noise and may change it from scan to scan.
  /// \return the fall that this scan completes: it has risen from the trough by the hysteresis.
  [[nodiscard]] std::optional<Fall> add(double value, double hysteresis);

  /// Scans since the last confirmed turning point; for finding out that nothing moves.
  [[nodiscard]] double scans_since_turn() const noexcept;
  [[nodiscard]] bool falling() const noexcept { return direction_ == Direction::kDown; }

 private:
  enum class Direction { kUnknown, kUp, kDown };

  /// A candidate for a turning point: its position in `scans_` is position − base_.
  struct Extreme {
    std::size_t position = 0;
    double value = 0.0;
  };

  void step(std::size_t position, double median, double hysteresis, std::optional<Fall>& fall);
  void forget_before(std::size_t position);
  [[nodiscard]] Fall describe(const Extreme& peak, const Extreme& trough) const;
  /// Refines an extreme with a parabola through the largest scan near it and its neighbours.
  /// \param sign  +1 for a maximum, −1 for a minimum.
  [[nodiscard]] std::pair<double, double> interpolate(const Extreme& extreme, double sign) const;
  [[nodiscard]] double at(std::size_t position) const noexcept { return scans_[position - base_]; }

  std::vector<double> scans_;    ///< From before the last confirmed turning point on.
  std::vector<double> medians_;  ///< Median of three around the same positions, one shorter.
  std::size_t base_ = 0;         ///< Position of scans_.front().
  std::size_t count_ = 0;        ///< Scans seen.
  Direction direction_ = Direction::kUnknown;
  Extreme high_;
  Extreme low_;
  Extreme turn_;  ///< The confirmed turning point before high_ (direction up) or peak (down).
};

}  // namespace stickslip::friction
