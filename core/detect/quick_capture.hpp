/// \file
/// The captured course of core/detect/live_captured_course through rows at equal times: slip, stick, slip
/// again, fitted at a hundredth of the price.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "core/detect/slip_rows.hpp"

namespace stickslip::detect {

/// Where c′ of a free course reaches the stick rate.
struct StickBegin {
  std::size_t row = 0;  ///< The last before; where it is looked for next.
  double tau_s = 0.0;   ///< After the first row.
  double level = 0.0;   ///< c there.
  TurnedBasis basis;    ///< ∂c/∂(A, B) there.
};

enum class Crossing {
  kThere,   ///< Before the newest row.
  kToCome,  ///< The course reaches it behind that.
  kNever,   ///< It turns round before.
};

/// \param begin  its row is where to look first, if it makes sense; becomes what is found.
[[nodiscard]] Crossing find_stick(const SlipRows& slip, const RowCourse& p, StickBegin& begin) noexcept;

/// The end of the rise of c′ of a course that does not reach the stick rate.
struct RiseEnd {
  std::size_t row = 0;  ///< Next to it, maybe to come.
  TurnedBasis basis;    ///< Of that row.
  double rate = 0.0;    ///< The highest c′.
};
[[nodiscard]] RiseEnd find_rise_end(const SlipRows& slip, const RowCourse& p) noexcept;

/// Parameters K, A, B of the slip, and S of the next.
class QuickCapture {
 public:
  QuickCapture() = default;

  /// The course whose slip fits the rows before its capture best, with the usual S − K of the next.
  /// \param guess  row before the capture. \param row_variance  σ² of a row.
  [[nodiscard]] Crossing start(const SlipRows& slip, std::size_t guess, double typical_delta_mu,
                               double row_variance) noexcept;
  /// Anew for rows that have come.
  [[nodiscard]] Crossing update(const SlipRows& slip) noexcept { return work_out(slip); }
  /// Steps towards the course of least cost, until it costs no more than that is enough. For the rows of the
  /// last start() or update().
  void improve(const SlipRows& slip, double enough) noexcept;

  [[nodiscard]] const RowCourse& slip() const noexcept { return p_; }
  [[nodiscard]] const StickBegin& stick() const noexcept { return stick_; }
  [[nodiscard]] double onset_tau_s() const noexcept { return onset_tau_s_; }
  /// What is unusual of the next S − K, in standard deviations.
  [[nodiscard]] double unusual() const noexcept { return unusual_; }
  /// Of the rows it was worked out for: half the sum of squares over the variance.
  [[nodiscard]] double cost() const noexcept { return cost_; }
  /// c while it sticks.
  [[nodiscard]] double line(double tau_s, double r) const noexcept {
    return stick_.level + r * (tau_s - stick_.tau_s);
  }
  /// Mean of c over a row of the next slip. \param b  the basis, turned since the onset.
  [[nodiscard]] double next_slip(const SlipRows& slip, const TurnedBasis& b) const noexcept {
    return p_.K + slip.attenuation() * (next_D_ * b.cosine + next_B_ * b.sine);
  }
  /// Over the rows behind the capture, in their order. \param on_line  called with a row and c there.
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
