/// \file
/// Present belt segment during a simulation, and the drift of K with time or travel.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>

#include "core/sim/belt_rate.hpp"
#include "core/sim/motion.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// Present position of the belt in its sequence of segments. Each `now` lies in the present segment.
class BeltWalk {
 public:
  /// \param motion  outlives this. \param scan_rate_Hz > 0
  BeltWalk(const Motion& motion, double scan_rate_Hz)
      : motion_(motion),
        scan_rate_Hz_(scan_rate_Hz),
        factor_(motion.oscillator.omega0_squared() / motion.gravity_m_per_s2) {}

  /// Returns to the state before the first segment: the belt rests, and segment_end() is scan 0.
  void restart() noexcept {
    next_ = 0;
    segment_ = {};
    start_ = {};
    end_ = {};
    travel_ = 0.0;
  }

  /// Enters the next segment, at segment_end(). After the last one the belt rests until kForEver.
  void next_segment() noexcept {
    travel_ = travel(end_);
    start_ = end_;
    segment_ = {};
    if (next_ == motion_.belt.size()) {
      end_ = kForEver;
      return;
    }
    segment_ = motion_.belt[next_++];
    end_ = start_.later(segment_.duration_s * scan_rate_Hz_);
  }

  /// Stops the belt from now to segment_end().
  void halt(const ScanTime& now) noexcept {
    travel_ = travel(now);
    start_ = now;
    segment_ = {};
  }

  /// Whether no segment has begun since restart().
  [[nodiscard]] bool before_first() const noexcept { return next_ == 0; }
  [[nodiscard]] bool halts_when_unloaded() const noexcept { return segment_.halt_when_unloaded; }
  [[nodiscard]] const ScanTime& segment_end() const noexcept { return end_; }
  /// Time until the end of the segment.
  [[nodiscard]] double left_s(const ScanTime& now) const noexcept {
    return end_.periods_since(now) / scan_rate_Hz_;
  }
  /// Belt rate of the segment, with t = 0 now.
  [[nodiscard]] BeltRate from(const ScanTime& now) const noexcept {
    return BeltRate::of(segment_, factor_, elapsed_s(now));
  }
  /// Net belt travel from scan 0 to now, as a coefficient: ω₀²/g times the travel in m.
  [[nodiscard]] double travel(const ScanTime& now) const noexcept {
    return travel_ + BeltRate::of(segment_, factor_, 0.0).travel(elapsed_s(now));
  }

 private:
  [[nodiscard]] double elapsed_s(const ScanTime& now) const noexcept {
    return now.periods_since(start_) / scan_rate_Hz_;
  }

  const Motion& motion_;
  double scan_rate_Hz_;
  double factor_;  ///< ω₀²/g
  std::size_t next_ = 0;
  BeltSegment segment_;
  ScanTime start_;
  ScanTime end_;
  double travel_ = 0.0;  ///< Up to start_.
};

/// Factor f of K (KineticDrift) during a piece of the motion; times count from the start of the piece.
struct DriftFactor {
  std::optional<KineticDrift> drift;
  double x = 0.0;        ///< x at the start of the piece, over the drift's scale.
  double x_per_s = 0.0;  ///< 1/scale of a drift over time, 1/s; else 0.
  double x_per_c = 0.0;  ///< g/(ω₀² scale) of a drift over belt travel: the travel is a coefficient; else 0.
  BeltRate belt;

  /// f(t); 1 without a drift.
  [[nodiscard]] double factor(double t_s) const noexcept {
    if (!drift) return 1.0;
    const double at = x + x_per_s * t_s + (x_per_c != 0.0 ? x_per_c * belt.travel(t_s) : 0.0);
    return 1.0 + drift->change * (linear() ? at : -std::expm1(-at));
  }
  /// f′(t), 1/s.
  [[nodiscard]] double slope(double t_s) const noexcept {
    return drift ? drift->change * decay(t_s) * (x_per_s + x_per_c * belt.at(t_s)) : 0.0;
  }
  /// Upper bound of |f″| for from ≤ t ≤ to, 1/s²; it need not be reached.
  [[nodiscard]] double most_curvature(double from_s, double to_s) const noexcept {
    if (!drift) return 0.0;
    const double bend = x_per_c * (x_per_c != 0.0 ? belt.most_slope(from_s, to_s) : 0.0);
    if (linear()) return std::abs(drift->change) * bend;
    const double speed = x_per_s + x_per_c * (x_per_c != 0.0 ? belt.most(from_s, to_s) : 0.0);
    // e^(−x) is largest where x is least.
    const double least = x_per_c == 0.0 ? decay(from_s) : decay(from_s) * std::exp(speed * (to_s - from_s));
    return std::abs(drift->change) * least * (speed * speed + bend);
  }

 private:
  [[nodiscard]] bool linear() const noexcept { return drift->form == KineticDrift::Form::kLinear; }
  [[nodiscard]] double decay(double t_s) const noexcept {
    if (linear()) return 1.0;
    return std::exp(-(x + x_per_s * t_s + (x_per_c != 0.0 ? x_per_c * belt.travel(t_s) : 0.0)));
  }
};

}  // namespace stickslip::sim
