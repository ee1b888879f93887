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

/// MotionSolver by CVODE. Its memory is constant; where MotionSolver promises not to allocate, only CVODE
/// itself may. Thread-bound.
///
/// next(), at(), follow_to() and skip() throw std::runtime_error if CVODE fails even with 10⁶ times the
/// chosen tolerance; then only restart() may follow. A smaller widening shows in method().accuracy.
class NumericSolver final : public MotionSolver {
 public:
  /// \param motion  is copied. \param scan_rate_Hz > 0.
  /// \param accuracy  asked of the coefficient while the belt's segments last, > 0.
  /// \param observer may be null; outlives the solver. \param seed as in restart().
  NumericSolver(const Motion& motion, double scan_rate_Hz, double accuracy,
                MotionObserver* observer = nullptr, std::uint64_t seed = 1);

  void restart(std::uint64_t seed) override;
  void next(std::span<double> coefficient) override;
  [[nodiscard]] double at(const ScanTime& instant) override;
  void follow_to(const ScanTime& instant, ForceFollower& follower) override;
  void skip(std::int64_t scans) override;
  /// The accuracy is the one asked for, or a larger one if rounding set the limit, or if CVODE has had to
  /// widen its tolerance since the construction; infinite if a belt segment lasts infinitely. Near grazing
  /// the time of a capture is less accurate: its error goes as the square root of that of the coefficient.
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
