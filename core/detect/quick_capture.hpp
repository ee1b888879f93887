/// \file
/// Captured trajectory (slip, stick, next slip) fitted to rows at equal intervals; a hundred times faster
/// than core/detect/live_captured_course.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "core/detect/slip_rows.hpp"

namespace stickslip::detect {

/// Capture: point at which c′ of a free oscillation reaches the stick rate.
struct StickBegin {
  std::size_t row = 0;  ///< The last before; where it is looked for next.
  double tau_s = 0.0;   ///< After the first row.
  double level = 0.0;   ///< c there.
  TurnedBasis basis;    ///< ∂c/∂(A, B) there.
};

enum class Crossing {
  kThere,   ///< Before the latest row.
  kToCome,  ///< After the latest row.
  kNever,   ///< c′ does not reach the stick rate.
};

/// \param begin  its row is the start of the search, if valid; becomes the capture found.
[[nodiscard]] Crossing find_stick(const SlipRows& slip, const RowCourse& p, StickBegin& begin) noexcept;

/// End of the rise of c′, for a free oscillation that does not reach the stick rate.
struct RiseEnd {
  std::size_t row = 0;  ///< Next to it, maybe to come.
  TurnedBasis basis;    ///< Of that row.
  double rate = 0.0;    ///< The highest c′.
};
[[nodiscard]] RiseEnd find_rise_end(const SlipRows& slip, const RowCourse& p) noexcept;

/// Fit of the captured trajectory, with parameters K, A, B of the slip, and S of the next slip.
class QuickCapture {
 public:
  QuickCapture() = default;

  /// Begins with the trajectory that fits the rows before its capture best, and the typical S − K of the next
  /// slip.
  /// \param guess  row before the capture. \param row_variance  σ² of a row.
  [[nodiscard]] Crossing start(const SlipRows& slip, std::size_t guess, double typical_delta_mu,
                               double row_variance) noexcept;
  /// Recomputes events and cost after new rows.
  [[nodiscard]] Crossing update(const SlipRows& slip) noexcept { return work_out(slip); }
  /// Iterates towards the least cost, until it is at most `enough`. Uses the rows of the last start() or
  /// update().
  void improve(const SlipRows& slip, double enough) noexcept;

  [[nodiscard]] const RowCourse& slip() const noexcept { return p_; }
  [[nodiscard]] const StickBegin& stick() const noexcept { return stick_; }
  [[nodiscard]] double onset_tau_s() const noexcept { return onset_tau_s_; }
  /// Deviation of the next S − K from the typical one, in standard deviations of the prior.
  [[nodiscard]] double unusual() const noexcept { return unusual_; }
  /// Cost over these rows: half the sum of squared residuals over the variance.
  [[nodiscard]] double cost() const noexcept { return cost_; }
  /// c during the stick.
  [[nodiscard]] double line(double tau_s, double r) const noexcept {
    return stick_.level + r * (tau_s - stick_.tau_s);
  }
  /// Mean of c over a row of the next slip. \param b  the basis, turned since the onset.
  [[nodiscard]] double next_slip(const SlipRows& slip, const TurnedBasis& b) const noexcept {
    return p_.K + slip.attenuation() * (next_D_ * b.cosine + next_B_ * b.sine);
  }
  /// Visits the rows after the capture in order. \param on_line  called with a row and c there.
  /// \param in_next  called with a row of the next slip, c there and the basis, turned since the onset.
  template <typename OnLine, typename InNext>
  void for_each_behind(const SlipRows& slip, const OnLine& on_line, const InNext& in_next) const {
    std::size_t k = stick_.row + 1;
    for (; k < slip.size() && slip.tau_s(k) <= onset_tau_s_; ++k)
      on_line(k, line(slip.tau_s(k), slip.shared().r));
    if (k >= slip.size()) return;
    TurnedBasis b = slip.later({}, slip.tau_s(k) - onset_tau_s_);
    for (; k < slip.size(); ++k, b = slip.a_row_later(b)) in_next(k, next_slip(slip, b), b);
  }

 private:
  /// Of a step, times σ² of a row.
  struct Equations {
    Eigen::Matrix4d normal;
    Eigen::Vector4d gradient;
  };

  /// Events and cost.
  [[nodiscard]] Crossing work_out(const SlipRows& slip) noexcept;
  [[nodiscard]] Equations equations(const SlipRows& slip) const noexcept;

  RowCourse p_;
  double S_ = 0.0;
  double typical_delta_mu_ = 0.0;
  double row_variance_ = 0.0;
  StickBegin stick_;
  double onset_tau_s_ = 0.0;
  double next_D_ = 0.0;
  double next_B_ = 0.0;
  double unusual_ = 0.0;
  double cost_ = 0.0;
};

}  // namespace stickslip::detect
