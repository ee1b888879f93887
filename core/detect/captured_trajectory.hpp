/// \file
/// Captured trajectory: the force of a slip, the stick after its capture, and the next slip; and its fit to
/// the scans so far.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/detect/free_oscillation.hpp"
#include "core/model/capture.hpp"

namespace stickslip::detect {

/// Standard deviation of ln(S − K) from slip to slip: √ln(1 + 0.6²), for a scatter of 60 %.
inline constexpr double kDeltaMuLogScatter = 0.5545;

/// Relative standard deviation of a stick rate estimated from a loading and one or two slips. A capture needs
/// c′ = r (20). If the largest c′ stays below r, the relative shortfall divided by this is one more residual.
inline constexpr double kStickRateSpread = 0.01;

/// Smallest ratio of S − K to its typical value; keeps the logarithm finite.
inline constexpr double kLeastRatio = 1e-6;

/// Belt under a slip. `course` must outlive what uses it.
struct BeltBelow {
  const model::BeltMotion* course = &model::constant_belt();
  double start_s = 0.0;  ///< Time of the slip's first point on the belt's time axis.

  friend bool operator==(const BeltBelow&, const BeltBelow&) = default;
};

/// Captured trajectory with fixed ω, γ and r. [Penner 1995, (11)–(14), (20)] Times named tau are seconds
/// after the slip's first point.
class CapturedTrajectory {
 public:
  /// K, c(0) − K, c′(0) in 1/s, and S of the next slip, with time 0 at the slip's first point.
  using Parameters = Eigen::Vector4d;

  CapturedTrajectory() = default;
  /// \param expected_capture_s  capture_s() of a slightly different trajectory: saves most of the search.
  CapturedTrajectory(const Parameters& parameters, const model::SharedParameters& shared,
                     const BeltBelow& belt, std::optional<double> expected_capture_s = {}) noexcept;

  /// Copy with another S − K of the next slip.
  [[nodiscard]] CapturedTrajectory with_next_delta_mu(double delta_mu) const noexcept;

  [[nodiscard]] const Parameters& parameters() const noexcept { return p_; }
  /// Capture time after the first point, s; the end of the rise of c′ if that does not reach the stick rate.
  [[nodiscard]] double capture_tau_s() const noexcept { return capture_tau_s_; }
  /// Capture time after the first point, s; nullopt if c′ does not reach the stick rate.
  [[nodiscard]] std::optional<double> capture_s() const noexcept {
    return is_captured_ ? std::optional{capture_tau_s_} : std::nullopt;
  }
  /// Onset of the next slip after the first point, s: the capture if S of the next slip is not above the
  /// coefficient there; infinity if the belt never raises c to S.
  [[nodiscard]] double onset_tau_s() const noexcept { return onset_tau_s_; }
  /// Basis to pass to residual() for the rows of one slip in the order of time.
  [[nodiscard]] model::TurnedBasis turned_basis() const noexcept {
    return model::TurnedBasis{shared_.oscillator()};
  }
  /// Residual of a row, in standard deviations; 0 for a stray.
  [[nodiscard]] double residual(const ScanRow& row, model::TurnedBasis& basis) const noexcept;

  /// Normal equations of the residuals, in the order of Parameters.
  struct Equations {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();  ///< Negative gradient of the cost.
    double cost = 0.0;                                   ///< In units of log-likelihood.
  };
  /// Prior terms: S − K of the next slip, and the shortfall of c′ below the stick rate.
  /// \param typical_delta_mu > 0.
  [[nodiscard]] Equations unusual(double typical_delta_mu) const noexcept;
  /// Prior terms plus the residuals of the rows, with Huber's weights (kChoiceLimit).
  /// \param rows  in the order of time.
  [[nodiscard]] Equations equations(std::span<const ScanRow> rows, double typical_delta_mu) const noexcept;

 private:
  /// Mean over a row of the next slip, and what its derivatives are made of.
  struct Point {
    double value = 0.0;
    double rate = 0.0;
    double by_D = 0.0;
    double sine = 0.0;
  };
  void set_next_S(double S) noexcept;
  [[nodiscard]] Point after_onset(const ScanRow& row, model::TurnedBasis& basis) const noexcept;
  [[nodiscard]] Parameters derivatives(const Point& at) const noexcept;
  /// At the mean time of a row: on a changing belt the mean over it differs by less than a tenth of σ.
  [[nodiscard]] double while_stuck(double tau_s) const noexcept {
    return at_capture_ +
           belt_.course->climb(shared_.r, belt_.start_s + capture_tau_s_, tau_s - capture_tau_s_);
  }

  Parameters p_ = Parameters::Zero();
  model::SharedParameters shared_;
  BeltBelow belt_;
  double omega0_squared_ = 0.0;
  bool is_captured_ = false;
  double capture_tau_s_ = 0.0;
  double at_capture_ = 0.0;
  FreeOscillation by_free_ = FreeOscillation::Zero();       ///< Of at_capture_.
  FreeOscillation rate_by_free_ = FreeOscillation::Zero();  ///< Of c′ there.
  double rate_at_capture_ = 0.0;                            ///< Of the belt, 1/s.
  double onset_tau_s_ = 0.0;
  double rate_at_onset_ = 0.0;   ///< Of the belt, 1/s,
  double slope_at_onset_ = 0.0;  ///< and its slope, 1/s².
};

/// A trajectory with its normal equations and cost.
struct FittedCapture {
  CapturedTrajectory trajectory;
  CapturedTrajectory::Equations equations;
};

/// Trajectory of least cost, from a first guess. Bounded time, no allocation.
/// \param first  first guess, with its equations for these rows.
/// \param sigma  noise of one scan: S − K of the next slip stays above −sigma.
/// \param most  limit of the iterations.
/// \return the best trajectory found, converged or not; the first guess if most is 0.
[[nodiscard]] FittedCapture fit_captured(const FittedCapture& first, std::span<const ScanRow> rows,
                                         const model::SharedParameters& shared, const BeltBelow& belt,
                                         double typical_delta_mu, double sigma, int most) noexcept;

}  // namespace stickslip::detect
