/// \file
/// Interface of the motion solvers, and the choice of one.
///
///     std::unique_ptr<MotionSolver> sled = make_motion_solver(motion, 350.0, 1e-6);
///     std::array<double, 64> coefficient;
///     sled->next(coefficient);  // scans 0 … 63
///     sled->method().name;      // "exact closed forms"
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "core/sim/motion.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// Accuracy of closed forms: a few roundings of a double. For its growth over n cycles see docs/accuracy.md.
inline constexpr double kExactAccuracy = 8.0 * std::numeric_limits<double>::epsilon();

/// Method of the solution, and its accuracy.
struct SolverMethod {
  std::string_view name;  ///< For people and records.
  double accuracy = 0.0;  ///< Expected largest error of the coefficient.
  /// Captures so far, found or not, that were closer than the accuracy can decide.
  std::int64_t undecided_count = 0;
};

/// Runs in constant memory. Thread-bound.
class MotionSolver {
 public:
  virtual ~MotionSolver() = default;

  /// Returns to scan 0, at rest and unloaded, with the random numbers of `seed`. Does not allocate.
  virtual void restart(std::uint64_t seed) = 0;

  /// Writes the coefficient F/(m g) at the next scans; the values do not depend on the division into calls.
  /// Does not allocate.
  virtual void next(std::span<double> coefficient) = 0;

  /// The coefficient at any instant; instants must not decrease. next() and skip() have a counter of their
  /// own and may continue only at scans not before the latest instant. Does not allocate.
  [[nodiscard]] virtual double at(const ScanTime& instant) = 0;

  /// As at(), but passes the continuous force since the last call to `follower`. Does not allocate.
  virtual void follow_to(const ScanTime& instant, ForceFollower& follower) = 0;

  /// Skips `scans` scans; takes time only for the events between.
  virtual void skip(std::int64_t scans) = 0;

  [[nodiscard]] virtual SolverMethod method() const = 0;
};

/// Whether every effect of this motion has a closed form. Not the nonlinear laws; not a drift of K that is
/// exponential over the travel of a belt that changes its speed; not a drift in resonance with an overdamped
/// oscillator.
[[nodiscard]] bool has_closed_form(const Motion& motion) noexcept;

/// The cheapest solver that meets the accuracy: closed forms wherever the motion admits them, since
/// they are both the fastest and the most accurate (docs/accuracy.md); else SUNDIALS CVODE.
/// \param scan_rate_Hz > 0.
/// \param accuracy  of the coefficient, > 0.
/// \param observer may be null; outlives the solver.
/// \param seed as in restart().
[[nodiscard]] std::unique_ptr<MotionSolver> make_motion_solver(const Motion& motion, double scan_rate_Hz,
                                                               double accuracy,
                                                               MotionObserver* observer = nullptr,
                                                               std::uint64_t seed = 1);

}  // namespace stickslip::sim
