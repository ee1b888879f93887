/// \file
/// Captured trajectory: the force of a slip, the stick after its capture, and the next slip; and its fit to
/// the scans so far.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/detect/live_free_course.hpp"
#include "core/model/capture.hpp"

namespace stickslip::detect {

/// Captured trajectory with fixed ω, γ and r. [Penner 1995, (11)–(14), (20)]
class LiveCapturedCourse {
 public:
  /// K, c(0) − K, c′(0), and S of the next slip.
  using Parameters = Eigen::Vector4d;

  LiveCapturedCourse() = default;
  /// \param expected_capture_s  capture time of a slightly different trajectory.
  LiveCapturedCourse(const Parameters& parameters, const model::SharedParameters& shared,
                     std::optional<double> expected_capture_s = {}) noexcept;

  /// Copy with another S − K of the next slip.
  [[nodiscard]] LiveCapturedCourse with_next_delta_mu(double delta_mu) const noexcept;

  [[nodiscard]] const Parameters& parameters() const noexcept { return p_; }
  /// Capture time after the first point, s; the end of the rise of c′ if that does not reach the stick rate.
  [[nodiscard]] double capture_tau_s() const noexcept { return capture_tau_s_; }
  /// Capture time after the first point, s; nullopt if c′ does not reach the stick rate.
  [[nodiscard]] std::optional<double> capture_s() const noexcept {
    return is_captured_ ? std::optional{capture_tau_s_} : std::nullopt;
  }
  [[nodiscard]] double onset_tau_s() const noexcept { return onset_tau_s_; }  ///< Of the next slip.
  /// Residual of a row, in standard deviations.
  [[nodiscard]] double residual(const LiveRow& row) const noexcept;

  /// Normal equations of the residuals.
  struct Equations {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    double cost = 0.0;
  };
  /// Prior terms: S − K of the next slip, and the shortfall of c′ below the stick rate.
  [[nodiscard]] Equations unusual(double typical_delta_mu) const noexcept;
  /// Prior terms plus the residuals of the rows, with Huber's weights.
  [[nodiscard]] Equations equations(std::span<const LiveRow> rows, double typical_delta_mu) const noexcept;

 private:
  /// Value, and derivatives.
  struct Point {
    double value = 0.0;
    Parameters by = Parameters::Zero();
  };
  void set_next_S(double S) noexcept;
  [[nodiscard]] Point after_onset(const LiveRow& row) const noexcept;
  [[nodiscard]] double while_stuck(double tau_s) const noexcept {
    return at_capture_ + shared_.r * (tau_s - capture_tau_s_);
  }

  Parameters p_ = Parameters::Zero();
  model::SharedParameters shared_;
  double omega0_squared_ = 0.0;
  bool is_captured_ = false;
  double capture_tau_s_ = 0.0;
  double at_capture_ = 0.0;
  LiveFreeCourse by_free_ = LiveFreeCourse::Zero();       ///< Of at_capture_.
  LiveFreeCourse rate_by_free_ = LiveFreeCourse::Zero();  ///< Of c′ there.
  double onset_tau_s_ = 0.0;
};

/// A trajectory with its normal equations and cost.
struct FittedCapture {
  LiveCapturedCourse course;
  LiveCapturedCourse::Equations equations;
};

/// Trajectory of least cost, from a first guess. Bounded time, no allocation.
[[nodiscard]] FittedCapture fit_captured(const FittedCapture& first, std::span<const LiveRow> rows,
                                         const model::SharedParameters& shared, double typical_delta_mu,
                                         double sigma) noexcept;

}  // namespace stickslip::detect
