#include "core/detect/ring_down_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace stickslip::detect {
namespace {

constexpr double kParameters = 3.0;

}  // namespace

void RingDownWatch::start(double omega, double gamma, double scan_rate_Hz) noexcept {
  running_ = true;
  turn_ = std::exp(std::complex<double>{-0.5 * gamma, omega} / scan_rate_Hz);
  // Whole scans; no fewer than leave an error to the fit.
  scans_in_period_ = std::max(std::round(2.0 * std::numbers::pi / omega * scan_rate_Hz), kParameters + 2.0);
  restart();
}

void RingDownWatch::restart() noexcept {
  wave_ = {1.0, 0.0};
  seen_ = squares_ = count_ = 0.0;
  normal_.setZero();
  right_.setZero();
}

std::optional<RingDownWatch::Amplitude> RingDownWatch::take(double value, bool usable) noexcept {
  if (usable) {
    if (count_ == 0.0) base_ = value;
    const double y = value - base_;
    const Eigen::Vector3d by{1.0, wave_.real(), wave_.imag()};
    normal_.noalias() += by * by.transpose();
    right_ += y * by;
    squares_ += y * y;
    count_ += 1.0;
  }
  wave_ *= turn_;
  seen_ += 1.0;
  if (seen_ < scans_in_period_) return std::nullopt;
  return close();
}

std::optional<RingDownWatch::Amplitude> RingDownWatch::close() noexcept {
  std::optional<Amplitude> amplitude;
  if (count_ > kParameters) {
    const Eigen::Matrix3d inverse = normal_.inverse();
    const Eigen::Vector3d p = inverse * right_;
    const double variance = std::max(squares_ - p.dot(right_), 0.0) / (count_ - kParameters);
    const double size = std::hypot(p[1], p[2]);
    const Eigen::Vector3d along{0.0, size > 0.0 ? p[1] / size : 1.0, size > 0.0 ? p[2] / size : 0.0};
    const double decay = std::abs(wave_);
    const double error = std::sqrt(variance * along.dot(inverse * along));
    if (std::isfinite(size) && std::isfinite(error)) amplitude = Amplitude{decay * size, decay * error};
  }
  restart();
  return amplitude;
}

}  // namespace stickslip::detect
