/// \file
/// Basis of a damped oscillation at rising, mostly equally spaced times: turned from one time to the next
/// instead of computed.
///
///     TurnedBasis basis{oscillator};
///     for (const double tau_s : times_s) use(basis.at(tau_s));
#pragma once

#include <cmath>
#include <limits>

#include "core/model/oscillator.hpp"

namespace stickslip::model {

/// Learns the step of the times: a time that continues with the step before takes four multiplications; any
/// other is computed by damped_basis(). Each turn adds a rounding error, some ε, and what the step is off by,
/// below kSameStep of it.
class TurnedBasis {
 public:
  /// \param oscillator  must oscillate.
  explicit TurnedBasis(const Oscillator& oscillator) noexcept
      : oscillator_(oscillator), omega_squared_(oscillator.omega_squared) {}

  [[nodiscard]] DampedBasis at(double tau_s) noexcept {
    const double step_s = tau_s - tau_s_;
    tau_s_ = tau_s;
    if (std::abs(step_s - step_s_) <= kSameStep * step_s_) {
      basis_ = {basis_.cosine * turn_.cosine - omega_squared_ * basis_.sine * turn_.sine,
                basis_.sine * turn_.cosine + basis_.cosine * turn_.sine};
      return basis_;
    }
    if (step_s > 0.0) {
      step_s_ = step_s;
      turn_ = damped_basis(oscillator_, step_s);
    }
    return basis_ = damped_basis(oscillator_, tau_s);
  }

 private:
  /// Times are k/rate, rounded: at 350 scans/s their differences differ by 1e-9 after a day.
  static constexpr double kSameStep = 1e-8;

  Oscillator oscillator_;
  double omega_squared_;
  double tau_s_ = std::numeric_limits<double>::infinity();
  double step_s_ = -1.0;  ///< None yet.
  DampedBasis turn_{1.0, 0.0};
  DampedBasis basis_{1.0, 0.0};
};

}  // namespace stickslip::model
