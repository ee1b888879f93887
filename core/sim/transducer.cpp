#include "core/sim/transducer.hpp"

#include <cmath>
#include <numbers>

#include <unsupported/Eigen/MatrixFunctions>

#include "core/base/contract.hpp"

namespace stickslip::sim {

Transducer::Transducer(const std::optional<LoadCellDynamics>& load_cell,
                       const std::optional<AntiAlias>& anti_alias, const friction::Oscillator& oscillator,
                       double scan_rate_Hz)
    : omega0_rad_per_s_(std::sqrt(oscillator.omega0_squared())),
      period_s_(1.0 / scan_rate_Hz),
      polynomial_(Matrix::Zero(kMaxSize, kMaxSize)) {
  STICKSLIP_EXPECTS(load_cell || anti_alias);
  polynomial_(0, 1) = omega0_rad_per_s_;
  polynomial_(1, 2) = omega0_rad_per_s_;
  if (load_cell) add_second_order(2.0 * std::numbers::pi * load_cell->frequency_Hz, load_cell->damping_ratio);
  if (anti_alias) {
    const double omega = 2.0 * std::numbers::pi * anti_alias->cutoff_Hz;
    const int order = anti_alias->order;
    // Poles evenly on the left half of a circle. [Butterworth, Wireless Engineer 7:536–541, 1930]
    for (int pair = 1; pair <= order / 2; ++pair) {
      add_second_order(omega, std::sin((2.0 * pair - 1.0) * std::numbers::pi / (2.0 * order)));
    }
    if (order % 2 == 1) add_first_order(omega);
  }
  polynomial_.conservativeResize(size_, size_);
  slip_ = polynomial_;
  slip_(2, 1) = -omega0_rad_per_s_;  // c‴ = −ω₀² c′ − γ c″
  slip_(2, 2) = -oscillator.gamma_per_s;
  polynomial_period_ = exponential(polynomial_ * period_s_);
  slip_period_ = exponential(slip_ * period_s_);
  restart();
}

void Transducer::restart() { state_ = Vector::Zero(size_); }

void Transducer::add_first_order(double omega_rad_per_s) {
  polynomial_(size_, size_) = -omega_rad_per_s;
  polynomial_(size_, output_) = omega_rad_per_s;
  output_ = size_;
  size_ += 1;
}

/// x₁′ = ω x₂, x₂′ = ω (input − x₁) − 2ζω x₂
void Transducer::add_second_order(double omega_rad_per_s, double damping_ratio) {
  polynomial_(size_, size_ + 1) = omega_rad_per_s;
  polynomial_(size_ + 1, size_) = -omega_rad_per_s;
  polynomial_(size_ + 1, size_ + 1) = -2.0 * damping_ratio * omega_rad_per_s;
  polynomial_(size_ + 1, output_) = omega_rad_per_s;
  output_ = size_;
  size_ += 2;
}

Transducer::Matrix Transducer::exponential(const Matrix& generator) { return generator.exp(); }

void Transducer::follow(const ForceStretch& stretch) {
  state_[0] = stretch.c;
  state_[1] = stretch.rate_per_s / omega0_rad_per_s_;
  state_[2] = stretch.acceleration_per_s2 / (omega0_rad_per_s_ * omega0_rad_per_s_);
  if (stretch.duration_s == period_s_) {
    state_ = (stretch.slips ? slip_period_ : polynomial_period_) * state_;
  } else {
    state_ = exponential((stretch.slips ? slip_ : polynomial_) * stretch.duration_s) * state_;
  }
}

}  // namespace stickslip::sim
