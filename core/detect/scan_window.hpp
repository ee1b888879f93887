/// \file
/// Rows of a fit: the points of one slip with the design matrix of a free oscillation, computed once for
/// each.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/estimate/cycle_buffer.hpp"
#include "core/estimate/huber.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::detect {

/// Parameters of a free oscillation, in which it is linear: K, c(0) − K, c′(0) in 1/s, with time from the
/// first point.
using FreeOscillation = Eigen::Vector3d;

/// Mean of neighbouring points. Members have no initial values, since an array of rows is only partly used.
struct ScanRow {
  double tau_s;             ///< Mean time after the first point of the slip.
  double value;             ///< Mean over its scans.
  double scale;             ///< root_count/σ; 0 for a stray.
  double root_count;        ///< √ of the number of its scans.
  double half_spread_s2;    ///< Half the variance of their times.
  double by_D;              ///< Coefficient of c(0) − K: derivative of the mean over the points.
  double by_rate;           ///< Coefficient of c′(0), s.
  double begin_s;           ///< CyclePoint::time_s of its first point,
  double end_s;             ///< and of its last.
  std::size_t first_point;  ///< Index of its first point.
  bool stray;               ///< Outlier, left out of the fits.

  /// Residual about a free oscillation, in standard deviations; 0 for a stray.
  [[nodiscard]] double free_residual(const FreeOscillation& p) const noexcept {
    return (value - (p[0] + (by_D * p[1] + by_rate * p[2]))) * scale;
  }
};

/// Rows of one slip, at most forty a period. Rows of the last evaluation are reused.
class ScanWindow {
 public:
  /// Makes the rows of these points. Rows that the result counts keep their outlier marks.
  /// \param points  of one slip, not empty, at most CycleBuffer::kMostPoints. From call to call with the same
  ///        first time, points may only be added at the end and merged: other values are not noticed.
  /// \param sigma  noise of one scan, > 0.
  /// \return number of leading rows known to be unchanged since the last call; 0 after points before the last
  /// row were merged, and after a change of ω, γ, sigma or the first point.
  std::size_t lay_out(std::span<const estimate::CyclePoint> points, const model::SharedParameters& shared,
                      double sigma) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::span<const ScanRow> all() const noexcept { return std::span{rows_}.first(size_); }
  [[nodiscard]] const ScanRow& back() const noexcept { return rows_[size_ - 1]; }
  [[nodiscard]] double sigma() const noexcept { return sigma_; }

  /// Marks the row of [from, to) with the largest residual as an outlier, if it exceeds
  /// estimate::kStraySigmas. Refused if more than three of all rows would be marked, or three or fewer of
  /// [from, to) would be left. Refused too if the rows that exceed it and those already marked are more than
  /// one in five of all: then neither trajectory describes them, and to leave some out would not help.
  /// \param sigmas_off  residual of a row about the better trajectory, in standard deviations; 0 for a stray.
  /// \return whether a row was marked.
  template <typename SigmasOff>
  bool leave_out_a_stray(std::size_t from, std::size_t to, SigmasOff sigmas_off) noexcept {
    std::size_t farthest = to;
    std::size_t count = 0;
    double off = estimate::kStraySigmas;
    for (std::size_t i = from; i < to; ++i) {
      const double z = std::abs(sigmas_off(rows_[i]));
      if (z > estimate::kStraySigmas) ++count;
      if (z > off) {
        off = z;
        farthest = i;
      }
    }
    return farthest != to && leave_out(farthest, count, from, to);
  }
  /// Removes the outlier marks of [from, to).
  void readmit(std::size_t from, std::size_t to) noexcept;

 private:
  [[nodiscard]] static ScanRow row_of(std::span<const estimate::CyclePoint> together, double first_s,
                                      const model::SharedParameters& shared) noexcept;
  /// \param count  of outliers, `which` among them.
  bool leave_out(std::size_t which, std::size_t count, std::size_t from, std::size_t to) noexcept;

  std::array<ScanRow, estimate::CycleBuffer::kMostPoints> rows_;
  std::size_t size_ = 0;
  double first_s_ = 0.0;
  model::SharedParameters shared_;
  double sigma_ = 0.0;
};

}  // namespace stickslip::detect
