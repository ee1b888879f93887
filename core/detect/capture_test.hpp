/// \file
/// Captured/free likelihood-ratio test: did a slip end in sticking, or does the oscillation go on? Used while
/// the scans of a slip arrive, and again at the end of a test; bounded time, no allocation.
///
/// Free: one decaying oscillation about one K (three parameters). Captured: the same until c′ = r (at the end
/// of the rise of c′ if it does not reach r, with the penalty of kStickRateSpread), stick at rate r to a new
/// S, then a second slip with the same K (four parameters). After a stick the next amplitude is at least
/// r/ω, and a free oscillation of smaller amplitude cannot reach c′ = r; this decides close to the threshold.
/// [Penner 1995, (20)–(22)] A capture followed at once by a slip with S hardly above K cannot be told from a
/// free oscillation; therefore S − K of the next slip has a prior, log-normal about the typical value.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "core/detect/captured_trajectory.hpp"
#include "core/detect/free_oscillation.hpp"

namespace stickslip::detect {

/// Standard deviation of the residuals, in σ, beyond which neither trajectory describes the scans.
inline constexpr double kMisfitSigmas = 2.0;

/// Likelihood density of an outlier, relative to the peak density of noise: one row (ScanRow) in twenty is a
/// missed spike, uniform within ±6 σ. It limits the log-likelihood ratio of a row to ln 101 = 4.6, so that
/// two outliers hardly decide; three rarely occur together.
inline constexpr double kStrayDensity = 0.01;

/// ln 10⁴, the log-likelihood ratio that decides: then one wrong end in ten thousand slips at most [Wald,
/// Ann. Math. Stat. 16:117–186, 1945, (3:42)].
inline constexpr double kDecisive = 9.210340371976184;

/// Effort of one evaluation.
struct Budget {
  /// Smallest |log-likelihood ratio| of interest. A ratio that is certainly smaller is not computed, which
  /// saves most of the time; then only CaptureEvidence::known is set. One that is computed may be too small:
  /// by up to 1, or by more if it exceeds this. 0: always compute, exactly.
  double decisive = 0.0;
  /// Limit of the iterations of each fit of the captured trajectory.
  int iterations = 8;
  /// Log-likelihood ratio that suffices for "captured". If the first guess of the captured trajectory exceeds
  /// it, the guess is not improved, and the ratio is a lower limit. Infinity: the guess is always improved.
  double enough = std::numeric_limits<double>::infinity();
};

/// What is known of a slip before the test.
struct CapturePrior {
  model::SharedParameters shared;  ///< ω, γ and r, held fixed.
  double sigma = 0.0;              ///< Noise of one scan, > 0.
  double typical_delta_mu = 0.0;   ///< Typical S − K of the test's slips, > 0.
  /// First guess of S − K of the next slip, if its peak has been seen; else the typical one is guessed.
  std::optional<double> next_delta_mu{};
  const model::BeltMotion* belt = &model::constant_belt();  ///< Must outlive the CaptureTest.
};

/// Result of CaptureTest::evaluate(). A ratio that was not computed leaves all members but `known` at their
/// initial values. Times are on the time axis of the points.
struct CaptureEvidence {
  /// Captured over free: > 0 for captured; about 0 while the scans do not decide.
  double log_likelihood_ratio = 0.0;
  /// Time of the capture in the captured trajectory, also where the free one is likelier.
  double capture_s = std::numeric_limits<double>::quiet_NaN();
  /// Onset of the next slip in the captured trajectory; may be yet to come; infinity if the belt never raises
  /// c to S.
  double next_onset_s = std::numeric_limits<double>::quiet_NaN();
  /// Robust standard deviation of the better trajectory's residuals, in σ. The prior terms of the captured
  /// one count as residuals.
  double residual_sigmas = 0.0;
  /// There were enough points for an evaluation: eight rows (ScanRow). False also for too many points.
  bool known = false;
};

/// Compares the captured and the free trajectory of a slip. Keeps rows and fits of the last evaluation, so
/// that evaluations of one slip, as its points come, cost less.
class CaptureTest {
 public:
  /// \param points  of a slip, from its force maximum on or from between onset and maximum; none, or more
  ///        than CycleBuffer::kMostPoints, leave the evidence unknown. From call to call they change only as
  ///        ScanWindow::lay_out() allows. Close above the threshold speed a free oscillation is often told
  ///        only when they reach the minimum after the next maximum.
  [[nodiscard]] CaptureEvidence evaluate(std::span<const estimate::CyclePoint> points,
                                         const CapturePrior& prior, const Budget& budget) noexcept;

 private:
  /// Both trajectories, each with its parameters of least cost.
  struct Trajectories {
    FreeOscillation free = FreeOscillation::Zero();
    double free_cost = 0.0;
    FittedCapture captured;
  };

  void lay_out(std::span<const estimate::CyclePoint> points, const CapturePrior& prior) noexcept;
  /// The trajectory that both begin with, unless it is the same as in the last evaluation.
  void fit_common() noexcept;
  /// Cost of all rows if the common trajectory goes on freely.
  [[nodiscard]] double carried_on_cost() const noexcept;
  [[nodiscard]] bool is_misfit(double cost) const noexcept;
  /// What a kind of trajectory costs at its best.
  struct Bounds {
    double least = 0.0;
    double most = 0.0;
  };
  /// By the last captured trajectory, if it goes on as it is.
  [[nodiscard]] Bounds last_captured_bounds() const noexcept;
  /// \param trajectories  its free trajectory is known. \param usual  as it usually goes on.
  void fit_captured_trajectory(Trajectories& trajectories, const FittedCapture& usual,
                               const Budget& budget) const noexcept;
  /// After the common trajectory. \return whether there was one.
  bool leave_out_a_stray_of_both(const Trajectories& trajectories) noexcept;
  /// Captured over free, where a spike tells no more than one scan can.
  [[nodiscard]] double log_likelihood_ratio(const Trajectories& trajectories,
                                            double residual_sigmas) const noexcept;

  [[nodiscard]] CaptureEvidence evidence_of(const Trajectories& trajectories, double first_s) const noexcept;

  ScanWindow rows_;
  CapturePrior prior_;
  BeltBelow belt_;
  // Of the evaluation before, as far as it still holds.
  FreeOscillation common_ = FreeOscillation::Zero();
  std::size_t common_count_ = 0;  ///< Rows of the common trajectory; 0 if there is none.
  double common_cost_ = 0.0;
  CapturedTrajectory usual_;     ///< As the common trajectory usually goes on if it is captured.
  FittedCapture last_captured_;  ///< Of the last answer that was worked out,
  std::size_t last_count_ = 0;   ///< its rows; 0 if there is none.
  bool strays_ = false;          ///< It left rows out after the common trajectory.
};

}  // namespace stickslip::detect
