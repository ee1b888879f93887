/// \file
/// Amplitude of a decaying oscillation, fitted period by period, to detect its end.
#pragma once

#include <complex>
#include <optional>

#include <Eigen/Core>

namespace stickslip::detect {

/// Fits K, a decaying cosine and sine with known ω and γ to each period by least squares. A period is a whole
/// number of scans, five at least. O(1) for a scan, no allocation.
class RingDownWatch {
 public:
  struct Amplitude {
    double value = 0.0;           ///< At the end of the period, coefficient.
    double standard_error = 0.0;  ///< From the residuals of the fit.

    /// Whether the amplitude is below three standard errors.
    [[nodiscard]] bool is_over() const noexcept { return !(value >= 3.0 * standard_error); }
  };

  /// Begins a period with the next scan, also where one was under way: to be called after a gap.
  /// \param omega  rad/s, damped, > 0. \param gamma  1/s. \param scan_rate_Hz > 0.
  void start(double omega, double gamma, double scan_rate_Hz) noexcept;
  void stop() noexcept { running_ = false; }
  [[nodiscard]] bool running() const noexcept { return running_; }

  /// \param value  coefficient. \param usable  false: the scan only advances time.
  /// \return the amplitude if this scan ends a period with four usable scans at least, which determine the
  /// fit. Nullopt otherwise, and if not running().
  std::optional<Amplitude> add(double value, bool usable) noexcept {
    if (!running_) return std::nullopt;
    return take(value, usable);
  }

 private:
  [[nodiscard]] std::optional<Amplitude> take(double value, bool usable) noexcept;
  [[nodiscard]] std::optional<Amplitude> close() noexcept;
  void restart() noexcept;

  bool running_ = false;
  std::complex<double> turn_;  ///< From one scan to the next.
  std::complex<double> wave_{1.0, 0.0};
  double scans_in_period_ = 0.0;
  double seen_ = 0.0;
  double base_ = 0.0;  ///< First value: sums of what differs from it do not cancel.
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  double squares_ = 0.0;
  double count_ = 0.0;
};

}  // namespace stickslip::detect
