/// \file
/// Interface of the two kinds of friction law that the numeric solver supports.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>

#include "core/sim/motion.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// The force of the spring as a coefficient, with its derivative.
struct SpringForce {
  double c = 0.0;
  double rate_per_s = 0.0;
};

/// The motion as consecutive intervals of time; it has been solved up to the end of the present one. Call
/// restart() first. Thread-bound.
class NumericMotion {
 public:
  virtual ~NumericMotion() = default;

  /// Returns to scan 0, with the coupling unloaded, or slack by startup_slack_m, and the random numbers of
  /// `seed`.
  virtual void restart(std::uint64_t seed) = 0;

  // The present interval, in which the force is known.
  [[nodiscard]] virtual const ScanTime& known_from() const = 0;
  [[nodiscard]] virtual const ScanTime& known_to() const = 0;
  /// \param instant  in the present interval.
  [[nodiscard]] virtual SpringForce force_at(const ScanTime& instant) const = 0;

  /// Advances to the next interval, which starts where this one ends. It may have zero length, as after an
  /// event. Not to be called where known_to() is kForEver. \throws std::runtime_error if CVODE fails
  /// (Cvode::step()); then only restart() may follow.
  virtual void advance() = 0;

  [[nodiscard]] virtual SolverMethod method() const = 0;
};

/// Makes the motion with Coulomb friction; K may depend on time, belt travel and the speed of sliding.
/// \param motion  is copied. \param observer  may be null; outlives the motion.
[[nodiscard]] std::unique_ptr<NumericMotion> make_sliding_motion(const Motion& motion, double scan_rate_Hz,
                                                                 double accuracy, MotionObserver* observer);
/// Makes the motion with rate-and-state friction. \param motion  with rate_and_state; is copied.
/// \param observer  may be null; outlives the motion.
[[nodiscard]] std::unique_ptr<NumericMotion> make_rate_and_state_motion(const Motion& motion,
                                                                        double scan_rate_Hz, double accuracy,
                                                                        MotionObserver* observer);

/// Time after which the clock of a piece that CVODE solves restarts at zero, so that its resolution stays
/// near 2⁻⁵²·64 s = 1e-14 s.
inline constexpr double kLongestPiece_s = 64.0;

/// Choice of CVODE's step tolerance for a requested accuracy.
///
/// The errors of the steps add up over a cycle, and, since each cycle starts where the last one ended, over
/// the cycles: error ≤ growth · (1 + T ω₀/2π) · tolerance, with the total duration T of the belt's segments,
/// and a growth that is measured for each method (tests/numeric/numeric_solver_accuracy_test.cpp).
struct ToleranceChoice {
  double tolerance = 0.0;  ///< Of a coefficient in one step; from least_tolerance to kCoarsest.
  /// Expected accuracy; larger than requested if least_tolerance sets the limit, infinite if T is.
  double accuracy = 0.0;

  /// \param accuracy  requested, > 0. \param least_tolerance  below which rounding dominates.
  static ToleranceChoice of(const Motion& motion, double accuracy, double growth, double least_tolerance) {
    double moving_s = 0.0;
    for (const BeltSegment& segment : motion.belt) moving_s += segment.duration_s;
    const double period_s = 2.0 * std::numbers::pi / std::sqrt(motion.oscillator.omega0_squared());
    const double all = growth * (1.0 + moving_s / period_s);
    const double tolerance = std::clamp(accuracy / all, least_tolerance, kCoarsest);
    return {tolerance, std::max(accuracy, all * tolerance)};
  }

 private:
  /// Largest tolerance; beyond it CVODE's steps are not small against a period.
  static constexpr double kCoarsest = 1e-4;
};

}  // namespace stickslip::sim
