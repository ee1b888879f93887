/// \file
/// Periodic stick-slip: the force of a pull whose slips share one S and one K. Cycles repeat exactly; six
/// parameters determine every onset and capture. [Penner 1995, (9)–(22)]
///
///     if (const auto course = UniformTrajectory::make({shared, {onset_s, S, K}})) {
///       const UniformPoint point = course->at(time_s);
///     }
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/model/slip_model.hpp"

namespace stickslip::model {

struct UniformParameters {
  SharedParameters shared;
  SlipParameters slip;  ///< Common to all slips; onset_s is that of the first.

  static constexpr Eigen::Index kOnset = 0;
  static constexpr Eigen::Index kS = 1;
  static constexpr Eigen::Index kK = 2;
  static constexpr Eigen::Index kOmega = 3;
  static constexpr Eigen::Index kGamma = 4;
  static constexpr Eigen::Index kR = 5;
  using Vector = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;

  [[nodiscard]] Vector vector() const {
    return (Vector{} << slip.onset_s, slip.S, slip.K, shared.omega, shared.gamma, shared.r).finished();
  }
  [[nodiscard]] static UniformParameters from(const Vector& p) {
    return {{p[kOmega], p[kGamma], p[kR]}, {p[kOnset], p[kS], p[kK]}};
  }
};

/// Value and derivatives at one time.
struct UniformPoint {
  double value = 0.0;
  /// By onset, S, K, ω, γ, r.
  UniformParameters::Vector by = UniformParameters::Vector::Zero();
};

/// Periodic trajectory with derivatives by its six parameters.
class UniformTrajectory {
 public:
  /// \return nullopt unless onset and ω are finite, ω > 0, |γ| < 2ω, S > K, r > 0, and the sled is captured.
  [[nodiscard]] static std::optional<UniformTrajectory> make(const UniformParameters& parameters);

  /// Coefficient at any time. Before the first onset a stick without a beginning: c goes below 0.
  [[nodiscard]] UniformPoint at(double time_s) const noexcept;

  /// The first cycle, which all repeat.
  [[nodiscard]] const SlipModel& slip() const noexcept { return slip_; }
  /// From a capture to the next; cycle 0 contains all times before its capture.
  struct Cycle {
    double number = 0.0;         ///< From 0.
    double after_first_s = 0.0;  ///< Time by which it follows cycle 0.
    double end_s = 0.0;          ///< Time of its capture; after the time asked for.
  };
  [[nodiscard]] Cycle cycle_at(double time_s) const noexcept;

  /// From onset to onset: the slip, and the stick that brings c from the capture back to S.
  [[nodiscard]] double period_s() const noexcept { return period_s_; }
  /// ∂ period/∂(onset, S, K, ω, γ, r). The shift of the capture time has no effect on it, since c′ = r there.
  [[nodiscard]] const UniformParameters::Vector& period_slope() const noexcept { return period_by_; }

 private:
  explicit UniformTrajectory(const UniformParameters& parameters);

  double onset_s_;
  SlipModel slip_;
  double period_s_ = 0.0;
  UniformParameters::Vector period_by_ = UniformParameters::Vector::Zero();
};

}  // namespace stickslip::model
