/// \file
/// Pull speed from a speed channel, reduced to lines between points: a PullSpeed that the fits use like a
/// plan.
///
///     MeasuredSpeed measured{MeasuredSpeed::resolution(noise_m_per_s, step_m_per_s)};
///     for (…) measured.add(time_s, speed_m_per_s);
///     if (const auto course = measured.course()) …
///
/// The first and the latest reading are points. A reading between them becomes one where no line from the
/// point before stays within the channel's resolution of every reading up to the next one. The speeds of the
/// points are the least-squares fit of the lines between them. This averages noise and rounding, so that they
/// do not appear as acceleration.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// Makes the course of the pull speed from readings that are added one by one. Stores the points only, not
/// the readings. Thread-bound.
class MeasuredSpeed {
 public:
  /// \param resolution_m_per_s  ≥ 0: largest error of a reading. A point that is no faster is at rest.
  explicit MeasuredSpeed(double resolution_m_per_s) : resolution_m_per_s_(resolution_m_per_s) {}

  /// Resolution of a channel: six standard deviations of a reading's noise, which is at least that of the
  /// rounding, step/√12.
  [[nodiscard]] static double resolution(double noise_m_per_s, double step_m_per_s) noexcept;

  /// \param time_s  0 for the first reading, then larger than that of the reading before.
  /// \param speed_m_per_s  finite.
  void add(double time_s, double speed_m_per_s);

  /// Pull speed from time 0 on. Sets a point at the latest reading; more readings may follow.
  /// \return nullopt if the belt never pulled, as without readings, or if more than PullSpeed::kMostPoints
  ///         points are needed.
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
