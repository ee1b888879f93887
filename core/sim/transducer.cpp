#include "core/sim/transducer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <unsupported/Eigen/MatrixFunctions>

#include "core/base/contract.hpp"

namespace stickslip::sim {

Transducer::Transducer(const std::optional<model::LoadCellDynamics>& load_cell,
                       const std::optional<model::AntiAlias>& anti_alias, const model::Oscillator& oscillator,
                       double scan_rate_Hz)
    : oscillator_(oscillator),
      omega0_rad_per_s_(std::sqrt(oscillator.omega0_squared())),
      period_s_(1.0 / scan_rate_Hz),
      filter_(Matrix::Zero(kMaxFilter, kMaxFilter)) {
  STICKSLIP_EXPECTS(load_cell || anti_alias);
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
  filter_.conservativeResize(size_, size_);
  restart();
}

void Transducer::restart() { state_ = Vector::Zero(size_); }

/// The first stage is driven by the force, each other one by the stage before.
void Transducer::take_input(int row, double omega) {
  if (output_ < 0) {
    input_row_ = row;
    input_ = omega;
  } else {
    filter_(row, output_) = omega;
  }
}

void Transducer::add_first_order(double omega_rad_per_s) {
  filter_(size_, size_) = -omega_rad_per_s;
  take_input(size_, omega_rad_per_s);
  output_ = size_;
  size_ += 1;
}

/// x₁′ = ω x₂, x₂′ = ω (input − x₁) − 2ζω x₂
void Transducer::add_second_order(double omega_rad_per_s, double damping_ratio) {
  filter_(size_, size_ + 1) = omega_rad_per_s;
  filter_(size_ + 1, size_) = -omega_rad_per_s;
  filter_(size_ + 1, size_ + 1) = -2.0 * damping_ratio * omega_rad_per_s;
  take_input(size_ + 1, omega_rad_per_s);
  output_ = size_;
  size_ += 2;
}

Transducer::Matrix Transducer::exponential(const Matrix& generator) { return generator.exp(); }

Transducer::Shape Transducer::shape_of(const ForceStretch& stretch) {
  Shape shape;
  shape.wave = stretch.wave != 0.0 || stretch.wave_rate_per_s != 0.0;
  shape.powers = stretch.course.powers();
  shape.decays = stretch.course.decays();
  for (int j = 0; j < shape.decays; ++j) {
    shape.rates_per_s.at(static_cast<std::size_t>(j)) = stretch.course.decay(j).rate_per_s;
    shape.orders.at(static_cast<std::size_t>(j)) = stretch.course.decay(j).orders;
  }
  return shape;
}

/// The force is the sum of the heads of a few chains of derivatives, each in units of ω₀ⁿ.
Transducer::Matrix Transducer::generator(const Shape& shape) const {
  int size = size_ + (shape.wave ? 2 : 0) + shape.powers;
  for (const int orders : shape.orders) size += orders;
  Matrix whole = Matrix::Zero(size, size);
  whole.topLeftCorner(size_, size_) = filter_;
  int at = size_;
  const auto chain = [&](int length, double last_rate) {
    if (length == 0) return;
    whole(input_row_, at) = input_;
    for (int i = 0; i + 1 < length; ++i) whole(at + i, at + i + 1) = omega0_rad_per_s_;
    at += length;
    whole(at - 1, at - 1) = -last_rate;
  };
  if (shape.wave) {
    chain(2, oscillator_.gamma_per_s);
    whole(at - 1, at - 2) = -omega0_rad_per_s_;
  }
  chain(shape.powers, 0.0);
  for (std::size_t j = 0; j < static_cast<std::size_t>(shape.decays); ++j)
    chain(shape.orders.at(j), shape.rates_per_s.at(j));
  return whole;
}

Transducer::Vector Transducer::start(const ForceStretch& stretch, const Shape& shape) const {
  Vector whole = Vector::Zero(kMaxSize);
  whole.head(size_) = state_;
  int at = size_;
  if (shape.wave) {
    whole[at++] = stretch.wave;
    whole[at++] = stretch.wave_rate_per_s / omega0_rad_per_s_;
  }
  double unit = 1.0;
  for (int k = 0; k < shape.powers; ++k) {
    if (k > 0) unit *= k / omega0_rad_per_s_;
    whole[at++] = stretch.course.power(k) * unit;
  }
  for (int j = 0; j < shape.decays; ++j) {
    // The i-th derivative of φ_m at 0 is (−λ)^(i−m), nothing before i = m: Horner's scheme from m = 0 on.
    const ExponentialPolynomial::Decay& decay = stretch.course.decay(j);
    double derivative = 0.0;
    unit = 1.0;
    for (int i = 0; i < decay.orders; ++i) {
      derivative = -decay.rate_per_s * derivative + decay.weight.at(static_cast<std::size_t>(i));
      whole[at++] = derivative * unit;
      unit /= omega0_rad_per_s_;
    }
  }
  whole.conservativeResize(at);
  return whole;
}

const Transducer::System& Transducer::system(const Shape& shape) {
  for (std::size_t i = 0; i < system_count_; ++i) {
    if (systems_.at(i).shape == shape) return systems_.at(i);
  }
  System& made = systems_.at(next_system_);
  made.shape = shape;
  made.generator = generator(shape);
  made.period = exponential(made.generator * period_s_);
  system_count_ = std::max(system_count_, next_system_ + 1);
  next_system_ = (next_system_ + 1) % kSystems;
  return made;
}

void Transducer::follow(const ForceStretch& stretch) {
  const Shape shape = shape_of(stretch);
  const System& whole = system(shape);
  const Vector before = start(stretch, shape);
  if (stretch.duration_s == period_s_) {
    state_ = (whole.period * before).head(size_);
  } else {
    state_ = (exponential(whole.generator * stretch.duration_s) * before).head(size_);
  }
}

}  // namespace stickslip::sim
