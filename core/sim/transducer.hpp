/// \file
/// Load cell and anti-alias filter as one linear system, driven by the force's closed form.
///
///     Transducer transducer{scene.load_cell_dynamics, scene.anti_alias, scene.oscillator, 350.0};
///     sled.follow_to(instant, transducer);
///     const double coefficient = transducer.output();
///
/// Each stretch of the force is a sum of motions that solve linear equations: the oscillation
/// h″ = −ω₀² h − γ h′, a polynomial (its last derivative does not change) and decays (the last of φ_m's
/// derivatives decays). With the transducer's x′ = A x + b c all are one homogeneous system, whose matrix
/// exponential is the exact response: no step size, no resonance that needs a case of its own, any damping.
/// [Van Loan, IEEE Trans. Automat. Contr. 23(3):395–404, 1978; exponential: Higham, SIAM J. Matrix Anal.
/// Appl. 26(4):1179–1193, 2005]
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "core/model/oscillator.hpp"
#include "core/model/transducer.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::sim {

/// Load cell and anti-alias filter: follow() takes the force in, output() is the response. Does not allocate
/// after construction. Thread-bound.
class Transducer final : public ForceFollower {
 public:
  /// At least one of load_cell and anti_alias must be given.
  /// \param oscillator    of the motion
  /// \param scan_rate_Hz  at which the force is mostly asked for: the responses over one whole period
  ///                      are computed only once.
  Transducer(const std::optional<model::LoadCellDynamics>& load_cell,
             const std::optional<model::AntiAlias>& anti_alias, const model::Oscillator& oscillator,
             double scan_rate_Hz);

  /// Returns to rest without force: output() is 0.
  void restart();

  void follow(const ForceStretch& stretch) override;

  /// The response, as a coefficient, at the end of the force passed so far.
  [[nodiscard]] double output() const { return state_[output_]; }

 private:
  static constexpr int kMaxFilter = 2 + model::AntiAlias::kHighestOrder;
  static constexpr int kMaxForce =
      2 + ExponentialPolynomial::kPowers + ExponentialPolynomial::kDecays * ExponentialPolynomial::kOrders;
  static constexpr int kMaxSize = kMaxFilter + kMaxForce;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSize, kMaxSize>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSize, 1>;

  /// Which motions a stretch has: what its system depends on.
  struct Shape {
    bool wave = false;
    int powers = 0;
    int decays = 0;
    std::array<double, ExponentialPolynomial::kDecays> rates_per_s{};
    std::array<int, ExponentialPolynomial::kDecays> orders{};
    bool operator==(const Shape&) const = default;
  };
  struct System {
    Shape shape;
    Matrix generator;  ///< Of (x, force), 1/s.
    Matrix period;     ///< Its exponential over one scan period.
  };
  static constexpr std::size_t kSystems = 6;  ///< A scene has two or three.

  [[nodiscard]] static Shape shape_of(const ForceStretch& stretch);
  void add_first_order(double omega_rad_per_s);
  void add_second_order(double omega_rad_per_s, double damping_ratio);
  void take_input(int row, double omega_rad_per_s);
  [[nodiscard]] const System& system(const Shape& shape);
  [[nodiscard]] Matrix generator(const Shape& shape) const;
  [[nodiscard]] Vector start(const ForceStretch& stretch, const Shape& shape) const;
  [[nodiscard]] static Matrix exponential(const Matrix& generator);

  model::Oscillator oscillator_;
  double omega0_rad_per_s_;  ///< Unit of 1/time of the force's derivatives, so that all are of one size.
  double period_s_;
  Matrix filter_;       ///< A
  double input_ = 0.0;  ///< b, of the row input_row_
  int input_row_ = 0;
  int size_ = 0;  ///< Of x
  int output_ = -1;
  Vector state_;  ///< x
  std::array<System, kSystems> systems_;
  std::size_t system_count_ = 0;
  std::size_t next_system_ = 0;
};

}  // namespace stickslip::sim
