/// \file
/// Finds the turning points of a noisy force: rises and falls that are large against the noise of a scan.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/signal/level_positions.hpp"
#include "core/signal/sliding_window.hpp"

namespace stickslip::detect {

/// A fall of the force between two turning points. Positions count the scans added, from 0; scans that are
/// missing do not count.
struct Fall {
  double peak_at = 0.0;    ///< Position of the maximum, interpolated between scans.
  double trough_at = 0.0;  ///< Position of the following minimum, interpolated.
  double peak = 0.0;       ///< Value at the maximum, interpolated.
  double trough = 0.0;     ///< Value at the minimum, interpolated.
  /// Scans from the last above 90 % to the first below 10 % of the drop. For a fall of more than
  /// signal::kMostSteps scans it may be too large by 0.2 % of the time from peak to trough. 0 if the first
  /// below comes before the last above.
  double duration = 0.0;
  /// Scans from the minimum before to the peak. 0 if the trace begins at the peak, or has not risen to it by
  /// more than the hysteresis.
  double rise_duration = 0.0;
  double rise_from = 0.0;  ///< Median of three at that minimum; at the peak if rise_duration is 0.

  double robust_drop = 0.0;  ///< Drop of the median of three, which noise hardly affects.

  [[nodiscard]] double drop() const noexcept { return peak - trough; }
};

/// Follows the force with hysteresis: a maximum is confirmed as soon as the force has fallen below it by the
/// hysteresis, a minimum likewise. Runs on the median of three scans, so that no single scan makes a turning
/// point; the values reported come from the scans themselves. Its memory, 100 kB, is taken when it is made
/// and does not depend on the trace; each scan costs amortised O(1). Move-only.
class FallFinder {
 public:
  /// \param value       despiked coefficient of the next scan; finite.
  /// \param hysteresis  > 0; the caller scales it to the noise and may change it from scan to scan. Infinite:
  ///        no turning point is confirmed.
  /// \return the fall that this scan confirms, else nullopt: the force has risen from the trough by more than
  /// the hysteresis. A fall with which the trace ends is not returned.
  [[nodiscard]] std::optional<Fall> add(double value, double hysteresis);

  /// Scans since the last confirmed turning point, or since the first scan; not before the first add().
  [[nodiscard]] double scans_since_turn() const noexcept;
  [[nodiscard]] bool falling() const noexcept { return direction_ == Direction::kDown; }
  /// Positions of the highest median since the last confirmed trough, and of the lowest since the last
  /// confirmed peak: while falling(), of the peak and of the trough so far.
  [[nodiscard]] std::size_t high_at() const noexcept { return high_.position; }
  [[nodiscard]] std::size_t low_at() const noexcept { return low_.position; }
  [[nodiscard]] double high() const noexcept { return high_.value; }  ///< The median at high_at().

 private:
  enum class Direction { kUnknown, kUp, kDown };

  /// Scans before and after a turning point that its interpolation may look at.
  static constexpr std::size_t kReach = 2;
  static constexpr std::size_t kScans = 2 * kReach + 1;

  /// Scans from position − kReach on, none before the trace.
  using Scans = std::array<double, kScans>;

  /// A candidate for a turning point.
  struct Extreme {
    std::size_t position = 0;
    double value = 0.0;  ///< Median of three.
  };

  [[nodiscard]] static double median_of_three(double a, double b, double c) noexcept {
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  }
  /// Keeps the scans about a candidate one scan after the last of them has come: while the force goes on, a
  /// better candidate has taken its place by then.
  void keep_scans(const Extreme& extreme, Scans& scans) const noexcept {
    if (count_ - 1 - extreme.position == kReach + 1) copy_scans(0, scans);
  }
  /// \param from  in latest_.
  void copy_scans(std::size_t from, Scans& scans) const noexcept {
    std::copy_n(latest_.values().data() + from, kScans, scans.data());
  }
  void step(std::size_t position, double median, double hysteresis, std::optional<Fall>& fall) noexcept;
  /// step() while the force rises.
  void rise(std::size_t position, double median, double hysteresis) noexcept;
  /// Into the stairs with those that wait. \param end  position behind the last of them.
  void take_waiting(std::size_t end) noexcept;
  void restart_at_high(std::size_t position, double median) noexcept;
  void fall_to(std::size_t position, double median) noexcept;
  [[nodiscard]] Fall describe(const Extreme& peak, const Extreme& trough) const noexcept;
  /// Refines an extreme with a parabola through the largest scan near it and its neighbours.
  /// \param sign  +1 for a maximum, −1 for a minimum.
  [[nodiscard]] static std::pair<double, double> interpolate(const Extreme& extreme, const Scans& scans,
                                                             double sign) noexcept;

  signal::SlidingWindow<kScans + 1> latest_;
  std::size_t count_ = 0;  ///< Scans seen.
  Direction direction_ = Direction::kUnknown;
  Extreme high_;
  Extreme low_;
  Scans about_high_{};  ///< Valid from kReach scans after it on.
  Scans about_low_{};
  Extreme turn_;  ///< The confirmed turning point before high_ (direction up) or peak (down).

  // Medians behind high_. While the force falls, those behind low_ are kept apart: the fall ends with low_.
  signal::LastAbove above_;
  signal::LastAbove above_after_low_;
  signal::FirstBelow below_;
  /// The newest medians of a rise: most are forgotten with the next high, before they were worth a step.
  std::array<double, 32> waiting_{};
  std::size_t waiting_count_ = 0;
};

// Each scan goes through these: in the caller's loop they cost 3 ns less.

inline std::optional<Fall> FallFinder::add(double value, double hysteresis) {
  latest_.push(value);
  ++count_;
  std::optional<Fall> fall;
  // A median of one.
  if (count_ == 1) high_ = low_ = turn_ = Extreme{0, value};
  if (count_ <= 2) return fall;
  keep_scans(high_, about_high_);
  keep_scans(low_, about_low_);
  const auto scans = latest_.values().last<3>();
  const double median = median_of_three(scans[0], scans[1], scans[2]);
  step(count_ - 2, median, hysteresis, fall);
  return fall;
}

inline void FallFinder::step(std::size_t position, double median, double hysteresis,
                             std::optional<Fall>& fall) noexcept {
  if (direction_ == Direction::kUp) return rise(position, median, hysteresis);
  if (direction_ == Direction::kUnknown && median > high_.value) {
    restart_at_high(position, median);
  } else {
    below_.add(position, median);
    if (!(median < low_.value)) {
      above_after_low_.add(position, median);
    } else if (above_after_low_.empty()) {  // Most of a fall: as fall_to(), by the direct way.
      low_ = {position, median};
      above_.add(position, median);
    } else {
      above_after_low_.add(position, median);
      fall_to(position, median);
    }
  }

  if (direction_ == Direction::kUnknown && median < high_.value - hysteresis) {
    // The high was a maximum, and the trace may have begun at it.
    turn_ = low_.position < high_.position ? low_ : high_;
    direction_ = Direction::kDown;
    fall_to(position, median);
  } else if (median > low_.value + hysteresis) {
    if (direction_ == Direction::kDown) {
      // The peak is as far back at the least as the scan before the trough.
      if (count_ - 1 - low_.position == kReach) copy_scans(1, about_low_);
      fall = describe(high_, low_);
    }
    direction_ = Direction::kUp;
    turn_ = low_;
    restart_at_high(position, median);
  }
}

inline void FallFinder::rise(std::size_t position, double median, double hysteresis) noexcept {
  if (median > high_.value) {
    restart_at_high(position, median);
    return;
  }
  if (waiting_count_ == waiting_.size()) take_waiting(position);
  waiting_[waiting_count_++] = median;
  if (!(median < high_.value - hysteresis)) return;
  // The high was a maximum.
  take_waiting(position + 1);
  direction_ = Direction::kDown;
  fall_to(position, median);
}

inline void FallFinder::restart_at_high(std::size_t position, double median) noexcept {
  high_ = {position, median};
  above_.clear();
  above_after_low_.clear();
  below_.clear();
  waiting_count_ = 0;
}

inline void FallFinder::fall_to(std::size_t position, double median) noexcept {
  low_ = {position, median};
  above_.take(above_after_low_);
}

}  // namespace stickslip::detect
