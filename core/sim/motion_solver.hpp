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

/// Accuracy of the coefficient from closed forms: a few roundings of a double. For its growth over n cycles
/// see docs/accuracy.md.
inline constexpr double kExactAccuracy = 8.0 * std::numeric_limits<double>::epsilon();

/// Method of the solution, and its accuracy.
struct SolverMethod {
  std::string_view name;  ///< For people and records.
  double accuracy = 0.0;  ///< Expected largest error of the coefficient.
  /// Captures since restart(), found or not, too close to grazing for the accuracy to tell whether they
  /// happen. Always 0 for closed forms and for rate-and-state friction.
  std::int64_t undecided_count = 0;
};

/// Computes the motion of the sled and shows its force, in the order of time. The constructor leaves it as
/// restart() does. Its memory is constant. Where it promises not to allocate, CVODE itself still may
/// (NumericSolver). Thread-bound.
class MotionSolver {
 public:
  virtual ~MotionSolver() = default;

  /// Returns to scan 0, with the coupling unloaded, or slack by startup_slack_m, and the random numbers of
  /// `seed`. Does not allocate.
  virtual void restart(std::uint64_t seed) = 0;

  /// Writes the coefficient F/(m g) at the next scans, from scan 0 on; the values do not depend on the
  /// division into calls. Does not allocate.
  virtual void next(std::span<double> coefficient) = 0;

  /// The coefficient at any instant, which must not be before one passed already by any call. It does not
  /// move the counter of next() and skip(), which may continue only at scans not before the latest instant.
  /// Does not allocate.
  [[nodiscard]] virtual double at(const ScanTime& instant) = 0;

  /// Passes the continuous force from the last call, or from scan 0, up to `instant` to `follower`. Between
  /// two calls nothing else may have moved the motion past the last instant. Does not allocate.
  virtual void follow_to(const ScanTime& instant, ForceFollower& follower) = 0;

  /// Skips `scans` ≥ 0 scans. Closed forms take time only for the events between; a numeric solver integrates
  /// all of it.
  virtual void skip(std::int64_t scans) = 0;

  [[nodiscard]] virtual SolverMethod method() const = 0;
};

/// Whether Propagator can solve this motion. It cannot with velocity_dependence or rate_and_state; with a
/// drift of K that is exponential over belt travel, if the speed changes within a segment (other than by
/// halt_when_unloaded); and with a drift of K if a decay, its own or, over belt travel, that of the belt's
/// speed, is nearly in resonance with the oscillator (|distance_from_resonance()| < 1e-3), which takes γ of
/// nearly 2ω₀ or more.
[[nodiscard]] bool has_closed_form(const Motion& motion) noexcept;

/// Makes the solver of a motion: Propagator if it has_closed_form(), since closed forms are the fastest and
/// the most accurate (docs/accuracy.md); else NumericSolver, whose calls may throw.
/// \param motion  in which expect_sound() finds no fault; is copied.
/// \param scan_rate_Hz > 0.
/// \param accuracy  asked of the coefficient, > 0; method() tells the one that is expected.
/// \param observer may be null; outlives the solver.
/// \param seed as in restart().
[[nodiscard]] std::unique_ptr<MotionSolver> make_motion_solver(const Motion& motion, double scan_rate_Hz,
                                                               double accuracy,
                                                               MotionObserver* observer = nullptr,
                                                               std::uint64_t seed = 1);

}  // namespace stickslip::sim
