/// \file
/// One interface for every way of solving the motion, and the choice among them.
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

/// Of closed forms: some roundings of a double. What n cycles make of it: docs/accuracy.md.
inline constexpr double kExactAccuracy = 8.0 * std::numeric_limits<double>::epsilon();

/// How the motion is solved, and how far its numbers can be trusted.
struct SolverMethod {
  std::string_view name;  ///< For people and records.
  double accuracy = 0.0;  ///< In use: largest error of the coefficient to be expected.
  /// Captures so far that happened, or did not, by less than the accuracy in use can tell.
  std::int64_t undecided_count = 0;
};

/// Needs the same memory however long it runs. Thread-bound.
class MotionSolver {
 public:
  virtual ~MotionSolver() = default;

  /// Back to scan 0, at rest and unloaded, with these random numbers. Does not allocate.
  virtual void restart(std::uint64_t seed) = 0;

  /// The coefficient F/(m g) at the next scans, the same however they are divided into calls. Does not
  /// allocate.
  virtual void next(std::span<double> coefficient) = 0;

  /// The coefficient at any instants in non-decreasing order; next() and skip() keep count of their
  /// own, and may go on only at scans that are not before the last instant. Does not allocate.
  [[nodiscard]] virtual double at(const ScanTime& instant) = 0;

  /// As at(), but shows the whole force since the last call instead of its value. Does not allocate.
  virtual void follow_to(const ScanTime& instant, ForceFollower& follower) = 0;

  /// Goes on by `scans` without looking at them, at the cost of the events alone.
  virtual void skip(std::int64_t scans) = 0;

  [[nodiscard]] virtual SolverMethod method() const = 0;
};

/// Does every effect of this motion admit closed forms? Not the nonlinear laws; not a drift of K that is
/// exponential over the travel of a belt that changes its speed; not a drift in resonance with an overdamped
/// oscillator.
[[nodiscard]] bool has_closed_form(const Motion& motion) noexcept;

/// The cheapest solver that meets the accuracy: closed forms wherever the motion admits them, since
/// they are both the fastest and the most accurate (docs/accuracy.md); else SUNDIALS CVODE.
/// \param scan_rate_Hz > 0. \param accuracy  of the coefficient, > 0. \param observer may be null; outlives
/// the solver. \param seed as in restart().
[[nodiscard]] std::unique_ptr<MotionSolver> make_motion_solver(const Motion& motion, double scan_rate_Hz,
                                                               double accuracy,
                                                               MotionObserver* observer = nullptr,
                                                               std::uint64_t seed = 1);

}  // namespace stickslip::sim
