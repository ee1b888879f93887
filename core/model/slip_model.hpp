/// \file
/// The force around one slip as a function of six parameters, with analytic derivatives: stick,
/// slip, and — if the slip ends in sticking — stick again. The one trajectory of all fits.
/// [Penner 1995, (11)–(14)]
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/belt_course.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/model/turned_basis.hpp"

namespace stickslip::model {

/// Parameters common to all slips of a test.
struct SharedParameters {
  double omega = 0.0;  ///< rad/s, damped.
  double gamma = 0.0;  ///< 1/s
  double r = 0.0;      ///< Stick rate, 1/s; on a changing belt at its largest speed (BeltCourse).

  [[nodiscard]] Oscillator oscillator() const noexcept {
    return Oscillator::from_omega(omega, gamma / (2.0 * omega));
  }
};

/// Parameters of one slip.
struct SlipParameters {
  double onset_s = 0.0;  ///< Time of the slip onset.
  double S = 0.0;        ///< Coefficient at the onset; S of the paper less a/g of an accelerating belt.
  double K = 0.0;        ///< Kinetic coefficient during the slip.
};

/// Value and derivatives at one time.
struct SlipModelPoint {
  using Derivatives = Eigen::Matrix<double, 6, 1>;

  double value = 0.0;
  double curvature = 0.0;                ///< c″ of the slip, 1/s²; 0 in a stick.
  Derivatives by = Derivatives::Zero();  ///< ∂/∂(onset, S, K, ω, γ, r)
  [[nodiscard]] auto by_slip() const noexcept { return by.head<3>(); }    ///< ∂/∂(onset, S, K)
  [[nodiscard]] auto by_shared() const noexcept { return by.tail<3>(); }  ///< ∂/∂(ω, γ, r)
};

/// One slip with fixed parameters, ready to be evaluated at many times.
class SlipModel {
 public:
  /// \param captured  the sled sticks again where c′ equals the stick rate (at t₃ if c′ does not reach it);
  ///        otherwise the oscillation never ends.
  /// \param belt  must outlive this object.
  /// \param expected_capture_s  capture_s() of a slightly different slip: saves most of the search.
  SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
            const BeltCourse& belt = constant_belt(), std::optional<double> expected_capture_s = {}) noexcept;

  [[nodiscard]] SlipModelPoint at(double time_s) const noexcept {
    return with_basis(time_s, [this](double tau_s) { return damped_basis(waveform_.oscillator, tau_s); });
  }
  /// \param basis  of the same ω and γ. Faster for many times in a row.
  [[nodiscard]] SlipModelPoint at(double time_s, TurnedBasis& basis) const noexcept {
    return with_basis(time_s, [&basis](double tau_s) { return basis.at(tau_s); });
  }
  [[nodiscard]] const SlipWaveform& waveform() const noexcept { return waveform_; }
  /// Seconds from onset to sticking; infinity if not captured.
  [[nodiscard]] double capture_s() const noexcept { return capture_s_; }

 private:
  template <typename BasisOf>
  [[nodiscard]] SlipModelPoint with_basis(double time_s, const BasisOf& basis_of) const noexcept {
    const double tau_s = time_s - slip_.onset_s;
    if (tau_s < 0.0 || tau_s > capture_s_) return sticking(tau_s);
    return slipping(tau_s, basis_of(tau_s));
  }
  [[nodiscard]] double capture_time(std::optional<double> expected_s) const noexcept;
  [[nodiscard]] SlipModelPoint slipping(double tau_s, const DampedBasis& basis) const noexcept;
  [[nodiscard]] SlipModelPoint sticking(double tau_s) const noexcept;

  SharedParameters shared_;
  SlipParameters slip_;
  const BeltCourse* belt_;
  SlipWaveform waveform_;
  double capture_s_;
  SlipModelPoint at_capture_;  ///< If captured; ∂/∂onset without the stick's part.
};

}  // namespace stickslip::model
