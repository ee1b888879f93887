/// \file
/// Live likelihood ratio of capture over free oscillation (core/detect/junction), for the slip under way.
/// Evaluated repeatedly as scans arrive; bounded time, no allocation.
#pragma once

#include <limits>
#include <span>

#include "core/detect/live_captured_course.hpp"
#include "core/detect/live_free_course.hpp"

namespace stickslip::detect {

/// Standard deviation of the residuals, in σ, beyond which neither trajectory describes the scans.
inline constexpr double kMisfitSigmas = 2.0;

/// Likelihood density of an outlier, relative to the peak density of noise: one scan in twenty is a missed
/// spike, uniform within the ±6 σ that the despiker lets pass. It limits the log-likelihood ratio of a scan
/// to ln 101 = 4.6, so that two outliers hardly decide; three rarely occur together.
inline constexpr double kStrayDensity = 0.01;

struct JunctionEvidence {
  /// Captured over free; about 0 while the scans do not decide.
  double log_likelihood_ratio = 0.0;
  double capture_s = std::numeric_limits<double>::quiet_NaN();     ///< If captured.
  double next_onset_s = std::numeric_limits<double>::quiet_NaN();  ///< If captured; may be yet to come.
  double residual_sigmas = 0.0;  ///< Standard deviation of the better trajectory's residuals, in σ.
  bool known = false;            ///< There were enough scans for an evaluation.
};

/// Evaluator with memory for the points of one slip.
class LiveJunction {
 public:
  /// \param points  from a maximum of the force on.
  /// \param shared  ω, γ and r, held fixed.
  /// \param sigma  noise of one scan.
  /// \param typical_delta_mu  typical S − K of the slips so far, > 0.
  /// \param decisive  smallest |log-likelihood ratio| of interest. A ratio that is certainly smaller is not
  ///        computed, which saves most of the time; then only `known` is set. 0: always compute.
  [[nodiscard]] JunctionEvidence ask(std::span<const estimate::CyclePoint> points,
                                     const model::SharedParameters& shared, double sigma,
                                     double typical_delta_mu, double decisive = 0.0) noexcept;

 private:
  /// Both trajectories, each with its parameters of least cost.
  struct Courses {
    LiveFreeCourse free = LiveFreeCourse::Zero();
    double free_cost = 0.0;
    FittedCapture captured;
  };

  void lay_out(std::span<const estimate::CyclePoint> points, const model::SharedParameters& shared,
               double sigma, double typical_delta_mu) noexcept;
  /// The course that both begin with, unless it is the same as at the last question.
  void fit_common() noexcept;
  /// Cost of all rows if the common course goes on freely.
  [[nodiscard]] double carried_on_cost() const noexcept;
  [[nodiscard]] bool is_misfit(double cost) const noexcept;
  /// What a kind of course costs at its best.
  struct Bounds {
    double least = 0.0;
    double most = 0.0;
  };
  /// By the last captured course, if it goes on as it is.
  [[nodiscard]] Bounds last_captured_bounds() const noexcept;
  /// \param courses  its free course is known. \param usual  as it usually goes on.
  void fit_captured_course(Courses& courses, const FittedCapture& usual, double decisive) const noexcept;
  /// After the common course. \return whether there was one.
  bool leave_out_a_stray_of_both(const Courses& courses) noexcept;
  /// Captured over free, where a spike tells no more than one scan can.
  [[nodiscard]] double log_likelihood_ratio(const Courses& courses, double residual_sigmas) const noexcept;

  [[nodiscard]] JunctionEvidence evidence_of(const Courses& courses, double first_s) const noexcept;

  LiveRows rows_;
  model::SharedParameters shared_;
  double typical_delta_mu_ = 0.0;
  // Of the question before, as far as it still holds.
  LiveFreeCourse common_ = LiveFreeCourse::Zero();
  std::size_t common_count_ = 0;  ///< Rows of the common course; 0 if there is none.
  double common_cost_ = 0.0;
  LiveCapturedCourse usual_;     ///< As the common course usually goes on if it is captured.
  FittedCapture last_captured_;  ///< Of the last answer that was worked out,
  std::size_t last_count_ = 0;   ///< its rows; 0 if there is none.
  bool strays_ = false;          ///< It left rows out after the common course.
};

}  // namespace stickslip::detect
