/// \file
/// The motion of the sled by SUNDIALS CVODE: any friction law of motion.hpp, to the accuracy asked for.
///
///     NumericSolver sled{motion, 350.0, 1e-6};
///     std::array<double, 64> coefficient;
///     sled.next(coefficient);   // scans 0 … 63
///     sled.method().accuracy;   // 1e-6, or what can be reached
///
/// Coulomb friction is never smoothed: sticking is a piece of its own, and each piece ends at an event
/// that is found in CVODE's dense output, also where it is only touched inside a step (cvode.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/sim/motion_solver.hpp"
#include "core/sim/numeric_motion.hpp"

namespace stickslip::sim {

/// Needs the same memory however long it runs; what "does not allocate" promises holds as far as CVODE
/// keeps to its own arrays. Thread-bound.
///
/// next(), at(), follow_to() and skip() throw std::runtime_error where CVODE cannot go on at any tolerance.
class NumericSolver final : public MotionSolver {
 public:
  /// \param scan_rate_Hz > 0. \param accuracy  of the coefficient over the belt's course, > 0.
  /// \param observer may be null; outlives the solver. \param seed as in restart().
  NumericSolver(const Motion& motion, double scan_rate_Hz, double accuracy,
                MotionObserver* observer = nullptr, std::uint64_t seed = 1);

  void restart(std::uint64_t seed) override;
  void next(std::span<double> coefficient) override;
  [[nodiscard]] double at(const ScanTime& instant) override;
  void follow_to(const ScanTime& instant, ForceFollower& follower) override;
  void skip(std::int64_t scans) override;
  /// The accuracy is the one asked for; larger where rounding, or a step that would not succeed, set the
  /// limit. Near grazing the time of a capture is less accurate, as its square root: physics of the motion,
  /// which no tolerance mends.
  [[nodiscard]] SolverMethod method() const override { return motion_->method(); }

 private:
  void pass_until(const ScanTime& instant);

  std::unique_ptr<NumericMotion> motion_;
  double scan_rate_Hz_;
  double follow_step_s_;  ///< Longest cubic that follow_to() shows.
  std::int64_t next_scan_ = 0;
  ScanTime followed_to_;
};

}  // namespace stickslip::sim
