/// \file
/// The force around one slip as a function of six parameters, with analytic derivatives: stick,
/// slip, and — if the slip ends in sticking — stick again. [Penner 1995, (11)–(14)]
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/belt_motion.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/model/turned_basis.hpp"

namespace stickslip::model {

/// Parameters common to all slips of a test.
struct SharedParameters {
  double omega = 0.0;  ///< rad/s, damped, > 0.
  double gamma = 0.0;  ///< 1/s; a fit may reach below 0.
  double r = 0.0;      ///< Stick rate, 1/s; on a changing belt at its largest speed (BeltMotion).

  [[nodiscard]] Oscillator oscillator() const noexcept {
    return Oscillator::from_omega(omega, gamma / (2.0 * omega));
  }
};

/// Parameters of one slip.
struct SlipParameters {
  double onset_s = 0.0;  ///< Time of the slip onset, on the trace's time axis.
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

enum class SlipPhase { kBefore, kSlip, kAfter };  ///< Stick, slip, stick again.

/// A trajectory at one time: its phase, its value, and the terms of which its derivatives are linear
/// combinations. The coefficients of these are the same at all times of a phase:
/// SlipModel::slip_coefficients(), SlipModel::stick_begin().
struct SlipPlace {
  SlipPhase phase = SlipPhase::kBefore;
  double value = 0.0;
  double way_s = 0.0;           ///< In a stick: BeltMotion::way_s() from the onset (kBefore) or the capture.
  double tau_s = 0.0;           ///< In the slip: time since the onset.
  DampedBasis basis{1.0, 0.0};  ///< In the slip: the basis at tau_s.
};

/// One slip with fixed parameters, ready to be evaluated at many times.
class SlipModel {
 public:
  /// \param shared  ω > 0.
  /// \param captured  if true, the sled sticks again where c′ reaches the belt's rate, or at
  ///        deciding_time_s() if it does not; if false, the oscillation never ends.
  /// \param belt  must outlive this object.
  /// \param expected_capture_s  capture_s() of a slightly different slip: on a constant belt it saves most of
  ///        the search.
  SlipModel(const SharedParameters& shared, const SlipParameters& slip, bool captured,
            const BeltMotion& belt = constant_belt(), std::optional<double> expected_capture_s = {}) noexcept;

  [[nodiscard]] SlipModelPoint at(double time_s) const noexcept {
    return point_at(
        place_at(time_s, [this](double tau_s) { return damped_basis(waveform_.oscillator, tau_s); }));
  }
  /// The value, and the terms of the derivatives: for sums over many times in rising order.
  /// \param basis  made from waveform().oscillator.
  [[nodiscard]] SlipPlace place(double time_s, TurnedBasis& basis) const noexcept {
    return place_at(time_s, [&basis](double tau_s) { return basis.at(tau_s); });
  }
  /// c″ of the slip, 1/s²; 0 in a stick.
  [[nodiscard]] double curvature(const SlipPlace& at) const noexcept {
    if (at.phase != SlipPhase::kSlip) return 0.0;
    return -shared_.gamma * waveform_.rate(at.basis) -
           waveform_.oscillator.omega0_squared() * (at.value - slip_.K);
  }
  /// ∂/∂(onset, S, K, ω, γ, r) at a place in the slip: this matrix times slip_terms() of it.
  using SlipCoefficients = Eigen::Matrix<double, 6, 5>;
  [[nodiscard]] const SlipCoefficients& slip_coefficients() const noexcept { return by_slip_terms_; }
  [[nodiscard]] static Eigen::Matrix<double, 5, 1> slip_terms(const SlipPlace& at) noexcept {
    return {1.0, at.basis.cosine, at.basis.sine, at.tau_s * at.basis.cosine, at.tau_s * at.basis.sine};
  }
  /// ∂/∂(onset, S, K, ω, γ, r) of a stick is this vector, with way_s added to the derivative by r.
  /// \param phase  kBefore or kAfter.
  [[nodiscard]] const SlipModelPoint::Derivatives& stick_begin(SlipPhase phase) const noexcept {
    return phase == SlipPhase::kBefore ? before_ : after_;
  }
  [[nodiscard]] const SlipWaveform& waveform() const noexcept { return waveform_; }
  /// Seconds from onset to sticking; infinity if made with captured = false. Finite is no proof of a capture:
  /// see the constructor.
  [[nodiscard]] double capture_s() const noexcept { return capture_s_; }

 private:
  template <typename BasisOf>
  [[nodiscard]] SlipPlace place_at(double time_s, const BasisOf& basis_of) const noexcept {
    const double tau_s = time_s - slip_.onset_s;
    if (tau_s < 0.0) {
      return {SlipPhase::kBefore, slip_.S + belt_->climb(shared_.r, slip_.onset_s, tau_s),
              belt_->way_s(slip_.onset_s, tau_s)};
    }
    if (tau_s > capture_s_) {
      const double since_s = tau_s - capture_s_;
      const double capture_at_s = slip_.onset_s + capture_s_;
      return {SlipPhase::kAfter, at_capture_ + belt_->climb(shared_.r, capture_at_s, since_s),
              belt_->way_s(capture_at_s, since_s)};
    }
    return slip_place(tau_s, basis_of(tau_s));
  }
  [[nodiscard]] SlipPlace slip_place(double tau_s, const DampedBasis& basis) const noexcept {
    // c = K + e^(−γτ/2) [D cos ωτ + B sin ωτ], B = (r + γD/2)/ω: (11) without a division by D.
    return {SlipPhase::kSlip, slip_.K + (waveform_.D * basis.cosine + omega_B_ * basis.sine), 0.0, tau_s,
            basis};
  }
  [[nodiscard]] double capture_time(std::optional<double> expected_s) const noexcept;
  [[nodiscard]] SlipModelPoint point_at(const SlipPlace& place) const noexcept;
  void set_slip_coefficients() noexcept;

  SharedParameters shared_;
  SlipParameters slip_;
  const BeltMotion* belt_;
  SlipWaveform waveform_;
  double omega_B_;
  double capture_s_;
  double at_capture_ = 0.0;  ///< If captured.
  SlipCoefficients by_slip_terms_ = SlipCoefficients::Zero();
  SlipModelPoint::Derivatives before_;
  SlipModelPoint::Derivatives after_ = SlipModelPoint::Derivatives::Zero();
};

}  // namespace stickslip::model
