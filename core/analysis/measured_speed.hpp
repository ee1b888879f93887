/// \file
/// The pull speed as a channel read it, scan by scan, as lines between points: what the fits take for a plan.
///
///     MeasuredSpeed measured{step_m_per_s, noise_m_per_s};
///     for (…) measured.add(time_s, speed_m_per_s);
///     if (const auto course = measured.course()) …
///
/// Points are set where no line through the one before stays within the channel's resolution of every
/// reading; their speeds are then those of the least-squares fit of lines between them, so that noise and
/// rounding of the readings are averaged away, and what is left of them does not look like acceleration.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// Memory: of the points alone. Thread-bound.
class MeasuredSpeed {
 public:
  /// \param resolution_m_per_s  ≥ 0: readings are off the true speed by no more, and less than that is rest.
  explicit MeasuredSpeed(double resolution_m_per_s) : resolution_m_per_s_(resolution_m_per_s) {}

  /// How far readings may stray from a line: six standard deviations of their noise, of which a rounding to
  /// steps has 1/√12 at least.
  [[nodiscard]] static double resolution(double noise_m_per_s, double step_m_per_s) noexcept;

  /// \param time_s  rises, from 0 s on.
  void add(double time_s, double speed_m_per_s);

  /// From time 0 on. \return nothing if the belt never pulled, or changed its speed more often than a
  /// PullSpeed can say.
  [[nodiscard]] std::optional<model::PullSpeed> course();

 private:
  /// A point, at the time of a reading, with its row of the fit's normal equations.
  struct Knot {
    double time_s = 0.0;
    double own = 0.0;
    double right = 0.0;  ///< With the next knot.
    double sum = 0.0;
  };
  /// Sums over the readings since the latest knot, x the time since it.
  struct Line {
    double n = 0.0;
    double x = 0.0;
    double xx = 0.0;
    double v = 0.0;
    double xv = 0.0;
  };

  void begin_line();
  /// Sets a knot at the latest reading.
  void end_line();

  double resolution_m_per_s_;
  std::vector<Knot> knots_;
  Line line_;
  double latest_s_ = 0.0;        ///< Of the readings.
  double anchor_m_per_s_ = 0.0;  ///< Where lines from the latest knot begin.
  double least_m_per_s2_ = 0.0;  ///< Slopes that keep to all readings since.
  double most_m_per_s2_ = 0.0;
};

}  // namespace stickslip::analysis
