/// \file
/// The question of core/friction/junction while the slip is still under way: was it captured, or does it go
/// on? Asked again as scans come in, so in bounded time and without allocating: linear least squares for the
/// free course, four parameters with analytic derivatives for the captured one, both with Huber's weights.
#pragma once

#include <array>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "core/friction/cycle_buffer.hpp"
#include "core/friction/slip_model.hpp"

namespace stickslip::friction {

/// Residuals that many times the noise: neither course describes the scans.
inline constexpr double kMisfitSigmas = 2.0;

struct JunctionEvidence {
  /// Captured over free; about 0 as long as the scans cannot tell.
  double log_likelihood_ratio = 0.0;
  double capture_s = std::numeric_limits<double>::quiet_NaN();     ///< If captured.
  double next_onset_s = std::numeric_limits<double>::quiet_NaN();  ///< If captured; may be yet to come.
  double residual_sigmas = 0.0;  ///< What the better of the two leaves, over the noise.
  bool known = false;            ///< There were scans enough to ask.
};

/// Room for the points of one question.
class LiveJunction {
 public:
  /// \param points  from a maximum of the force on. \param shared  ω, γ and r, held fixed.
  /// \param sigma   noise of one scan. \param typical_delta_mu  S − K of the slips so far, roughly; > 0.
  /// \param decisive  of the ratio's size. An answer that is certainly smaller is not worked out, which is
  /// most of the time it costs: `known`, and nothing more. 0: always.
  [[nodiscard]] JunctionEvidence ask(std::span<const CyclePoint> points, const SharedParameters& shared,
                                     double sigma, double typical_delta_mu, double decisive = 0.0) noexcept;

 private:
  struct Row {
    double tau_s = 0.0;  ///< After the first point.
    double value = 0.0;  ///< Of the point.
    double scale = 0.0;  ///< √count/σ; 0 for a stray.
    double root_count = 0.0;
    double half_spread_s2 = 0.0;
    double by_D = 0.0;     ///< What c(0) − K adds, its mean over the point.
    double by_rate = 0.0;  ///< What c′(0) adds, s.
    double begin_s = 0.0;  ///< Time of its first point,
    double end_s = 0.0;    ///< and of its last.
    bool stray = false;    ///< No course explains it: left out.
  };
  using Free = Eigen::Vector3d;      ///< K, c(0) − K, c′(0)
  using Captured = Eigen::Vector4d;  ///< … and S of the next slip

  /// The events of a captured course.
  struct Events {
    double capture_tau_s = 0.0;
    bool is_captured = false;  ///< Else capture_tau_s is where c′ comes closest to the stick rate.
    double at_capture = 0.0;
    Eigen::Vector3d by_free = Eigen::Vector3d::Zero();       ///< Of at_capture.
    Eigen::Vector3d rate_by_free = Eigen::Vector3d::Zero();  ///< Of c′ there.
    double onset_tau_s = 0.0;
  };

  /// Of neighbouring points.
  [[nodiscard]] static Row row_of(std::span<const CyclePoint> together, double first_s,
                                  const SharedParameters& shared) noexcept;
  [[nodiscard]] static double free_residual(const Row& row, const Free& p) noexcept {
    return (row.value - (p[0] + (row.by_D * p[1] + row.by_rate * p[2]))) * row.scale;
  }
  [[nodiscard]] std::span<const Row> rows() const noexcept { return std::span{rows_}.first(size_); }
  /// The rows of these points; those that were there at the last question are kept.
  void lay_out(std::span<const CyclePoint> points, const SharedParameters& shared, double sigma) noexcept;
  /// Best free course of the first `count` rows. \return its cost.
  double fit_free(std::size_t count, Free& p) const noexcept;
  /// Leaves out the row among these that is farthest off, if no noise is so far off and not too many are left
  /// out already. \param sigmas_off  of a row, how far from what explains it best. \return whether it did.
  template <typename SigmasOff>
  bool leave_out_a_stray(std::span<Row> among, SigmasOff sigmas_off) noexcept;
  /// The course that both begin with, unless it is the same as at the last question.
  void fit_common(const SharedParameters& shared, double typical_delta_mu) noexcept;
  /// The common course as it goes on if it is captured, with so much S − K of the next slip.
  [[nodiscard]] Captured usual_capture(double delta_mu) const noexcept;
  /// Cost of all rows if the common course goes on freely.
  [[nodiscard]] double carried_on_cost() const noexcept;
  [[nodiscard]] Events events_of(const Captured& p, const SharedParameters& shared) const noexcept;
  /// Value of the captured course, and its derivatives.
  struct Point {
    double value = 0.0;
    Captured by = Captured::Zero();
  };
  [[nodiscard]] static Point captured_at(const Row& row, const Captured& p, const Events& events,
                                         const SharedParameters& shared) noexcept;
  struct Assembled {
    Eigen::Matrix4d normal;
    Eigen::Vector4d gradient;
    double cost;
  };
  /// What of a captured course is unusual: its S − K, and a c′ that does not reach the stick rate.
  [[nodiscard]] static Assembled unusual(const Captured& p, const Events& events,
                                         const SharedParameters& shared, double typical_delta_mu) noexcept;
  [[nodiscard]] Assembled assemble(const Captured& p, const SharedParameters& shared,
                                   double typical_delta_mu) const noexcept;
  /// Captured over free, where a spike tells no more than one scan can.
  [[nodiscard]] double log_likelihood_ratio(const Free& free, const Captured& captured,
                                            const SharedParameters& shared, double typical_delta_mu,
                                            double residual_sigmas) const noexcept;
  /// \param now  assembled at p.
  double fit_captured(Captured& p, Assembled now, const SharedParameters& shared,
                      double typical_delta_mu) const noexcept;

  /// Both courses, each at its best.
  struct Courses {
    Free free = Free::Zero();
    double free_cost = 0.0;
    Captured captured = Captured::Zero();
    double captured_cost = std::numeric_limits<double>::infinity();
  };
  /// \param courses  its free course is known. \param usual  assembled at usual_capture().
  void fit_captured_course(Courses& courses, const Assembled& usual, const SharedParameters& shared,
                           double typical_delta_mu) const noexcept;
  /// After the common course. \return whether there was one.
  bool leave_out_a_stray_of_both(const Courses& courses, const SharedParameters& shared) noexcept;

  std::array<Row, CycleBuffer::kMostPoints> rows_;
  std::size_t size_ = 0;
  // Of the last question.
  double first_s_ = 0.0;
  SharedParameters shared_;
  double sigma_ = 0.0;
  Free common_ = Free::Zero();
  std::size_t common_count_ = 0;  ///< Rows of the common course; 0 if there is none.
  double common_cost_ = 0.0;
  double common_capture_tau_s_ = 0.0;
  double common_typical_ = 0.0;
  double common_r_ = 0.0;
};

}  // namespace stickslip::friction
