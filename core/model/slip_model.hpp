/// \file
/// The force around one slip as a function of six parameters, with analytic derivatives: stick,
/// slip, and — if the slip ends in sticking — stick again. [Penner 1995, (11)–(14)]
#pragma once

#include <Eigen/Core>

#include "core/model/belt_course.hpp"
#include "core/model/slip_waveform.hpp"

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
  double value = 0.0;
  Eigen::Vector3d by_slip = Eigen::Vector3d::Zero();    ///< ∂/∂(onset, S, K)
  Eigen::Vector3d by_shared = Eigen::Vector3d::Zero();  ///< ∂/∂(ω, γ, r)
};

/// One slip with fixed parameters, ready to be evaluated at many times.
class SlipModel {
 public:
  /// \param captured  the sled sticks again where c′ equals the stick rate (at t₃ if c′ does not reach it);
  ///        otherwise the oscillation never ends.
  /// \param belt  must outlive this object.
  SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
            const BeltCourse& belt = constant_belt()) noexcept;

  [[nodiscard]] SlipModelPoint at(double time_s) const noexcept;
  [[nodiscard]] const SlipWaveform& waveform() const noexcept { return waveform_; }
  /// Seconds from onset to sticking; infinity if not captured.
  [[nodiscard]] double capture_s() const noexcept { return capture_s_; }

 private:
  [[nodiscard]] SlipModelPoint slipping(double tau_s) const noexcept;

  SharedParameters shared_;
  SlipParameters slip_;
  const BeltCourse* belt_;
  SlipWaveform waveform_;
  double capture_s_;
  SlipModelPoint at_capture_;  ///< If captured; ∂/∂onset without the stick's part.
};

}  // namespace stickslip::model
