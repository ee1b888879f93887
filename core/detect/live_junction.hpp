/// \file
/// The question of core/detect/junction while the slip is still under way: was it captured, or does it go
/// on? Asked again as scans come in, so in bounded time and without allocating.
#pragma once

#include <limits>
#include <span>

#include "core/detect/live_captured_course.hpp"
#include "core/detect/live_free_course.hpp"

namespace stickslip::detect {

/// Residuals that many times the noise: neither course describes the scans.
inline constexpr double kMisfitSigmas = 2.0;

/// Density, over that of noise at its middle, of scans that no course explains: one in twenty is a spike that
/// was not found, anywhere within the ±6 σ that the despiker lets pass. A scan tells ln 101 = 4.6 at most:
/// two strays hardly decide, three seldom meet.
inline constexpr double kStrayDensity = 0.01;

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
  [[nodiscard]] JunctionEvidence ask(std::span<const estimate::CyclePoint> points,
                                     const model::SharedParameters& shared, double sigma,
                                     double typical_delta_mu, double decisive = 0.0) noexcept;

 private:
  /// Both courses, each at its best.
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
