/// \file
/// Load cell and anti-alias filter as one linear system, driven by the force's closed form.
///
///     Transducer transducer{scene.load_cell_dynamics, scene.anti_alias, scene.oscillator, 350.0};
///     sled.follow_to(instant, transducer);
///     const double coefficient = transducer.output();
///
/// Each stretch of the force solves w′ = S w with w = (c, c′, c″): S is that of the oscillator while the
/// sled slips, and nilpotent while the force is a line or a parabola. With the transducer's
/// x′ = A x + b c the two are one homogeneous system, whose matrix exponential is the exact response: no
/// step size, no resonance that needs a case of its own, any damping. [Van Loan, IEEE Trans. Automat.
/// Contr. 23(3):395–404, 1978; exponential: Higham, SIAM J. Matrix Anal. Appl. 26(4):1179–1193, 2005]
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/friction/oscillator.hpp"
#include "core/sim/propagator.hpp"
#include "core/sim/transducer_settings.hpp"

namespace stickslip::sim {

/// Does not allocate after construction. Thread-bound.
class Transducer final : public ForceFollower {
 public:
  /// What is not given is not built; at least one is.
  /// \param oscillator    of the motion
  /// \param scan_rate_Hz  at which the force is mostly asked for: the responses over one whole period
  ///                      are computed only once.
  Transducer(const std::optional<LoadCellDynamics>& load_cell, const std::optional<AntiAlias>& anti_alias,
             const friction::Oscillator& oscillator, double scan_rate_Hz);

  /// At rest and unloaded.
  void restart();

  void follow(const ForceStretch& stretch) override;

  /// The coefficient as the converter sees it at the end of what was followed.
  [[nodiscard]] double output() const { return state_[output_]; }

 private:
  static constexpr int kForceSize = 3;
  static constexpr int kMaxSize = 2 + AntiAlias::kHighestOrder + kForceSize;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSize, kMaxSize>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSize, 1>;

  void add_first_order(double omega_rad_per_s);
  void add_second_order(double omega_rad_per_s, double damping_ratio);
  [[nodiscard]] static Matrix exponential(const Matrix& generator);

  double omega0_rad_per_s_;  ///< Unit of 1/time of w, so that its parts are of one size.
  double period_s_;
  Matrix polynomial_;         ///< Generator of (w, x) while the force is a line or a parabola, 1/s.
  Matrix slip_;               ///< The same while the sled slips.
  Matrix polynomial_period_;  ///< Their exponentials over one scan period.
  Matrix slip_period_;
  int size_ = kForceSize;
  int output_ = 0;
  Vector state_;
};

}  // namespace stickslip::sim
