/// \file
/// The points of one slip as the rows of a fit: what a free course of them is, worked out once for each.
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

/// A free course, linear in its parameters: K, c(0) − K, c′(0); times from the first point.
using LiveFreeCourse = Eigen::Vector3d;

/// Neighbouring points together. Without initial values: an array of them needs none.
struct LiveRow {
  double tau_s;  ///< Mean time after the first point.
  double value;  ///< Mean of the points.
  double scale;  ///< √count/σ; 0 for a stray.
  double root_count;
  double half_spread_s2;
  double by_D;              ///< What c(0) − K adds, its mean over the points.
  double by_rate;           ///< What c′(0) adds, s.
  double begin_s;           ///< Time of its first point,
  double end_s;             ///< and of its last.
  std::size_t first_point;  ///< Index of it.
  bool stray;               ///< No course explains it: left out.

  /// Off a free course, in standard deviations.
  [[nodiscard]] double free_residual(const LiveFreeCourse& p) const noexcept {
    return (value - (p[0] + (by_D * p[1] + by_rate * p[2]))) * scale;
  }
};

/// Rows of a question, forty a period at most. Those that were there at the last one are kept.
class LiveRows {
 public:
  /// \return so many rows at the beginning are as they were the last time, for the same courses and noise.
  std::size_t lay_out(std::span<const estimate::CyclePoint> points, const model::SharedParameters& shared,
                      double sigma) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::span<const LiveRow> all() const noexcept { return std::span{rows_}.first(size_); }
  [[nodiscard]] const LiveRow& back() const noexcept { return rows_[size_ - 1]; }
  [[nodiscard]] double sigma() const noexcept { return sigma_; }

  /// Leaves out the row of [from, to) that is farthest off, if no noise is so far off and not too many are
  /// left out already. \param sigmas_off  of a row, how far from what explains it best. \return whether it
  /// did.
  template <typename SigmasOff>
  bool leave_out_a_stray(std::size_t from, std::size_t to, SigmasOff sigmas_off) noexcept {
    std::size_t farthest = to;
    double off = estimate::kStraySigmas;
    for (std::size_t i = from; i < to; ++i) {
      if (const double z = std::abs(sigmas_off(rows_[i])); z > off) {
        off = z;
        farthest = i;
      }
    }
    return farthest != to && leave_out(farthest, from, to);
  }
  /// None of [from, to) is a stray any more.
  void readmit(std::size_t from, std::size_t to) noexcept;

 private:
  [[nodiscard]] static LiveRow row_of(std::span<const estimate::CyclePoint> together, double first_s,
                                      const model::SharedParameters& shared) noexcept;
  bool leave_out(std::size_t which, std::size_t from, std::size_t to) noexcept;

  std::array<LiveRow, estimate::CycleBuffer::kMostPoints> rows_;
  std::size_t size_ = 0;
  double first_s_ = 0.0;
  model::SharedParameters shared_;
  double sigma_ = 0.0;
};

}  // namespace stickslip::detect
