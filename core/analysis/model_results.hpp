/// \file
/// Results with standard errors, and the table of cycles, from the fitted slips.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/analysis/mean_residual.hpp"
#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/detect/cycle.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

/// Largest standard deviation of the residuals, over the noise of a scan, up to which the model counts as
/// describing the trace.
inline constexpr double kLargestResidualSigmas = 5.0;

/// Whether the fit converged, its residuals are at most kLargestResidualSigmas σ, its damping is neither
/// significantly negative nor, within two standard errors, overdamped, no slips with a rest between them
/// certainly come faster than its oscillation, and, on a constant belt, no slip certainly ended otherwise
/// than its Q and the threshold [22] say.
/// \param sigma  noise of one scan.
[[nodiscard]] bool model_describes(const SlipEstimates& estimates, double sigma);

/// Slips that count in the means, of those that began from sticking. Of three or more the first and those
/// after a hold are left out, unless estimates.first_counts or no other is left. Of the others those are left
/// out whose error of S − K exceeds the median |S − K|, as few scans make it (a gap, spikes, the end of the
/// pull), unless all do.
/// \param estimates  converged.
[[nodiscard]] std::vector<estimate::SlipWindow> slips_that_count(const SlipEstimates& estimates);

/// Parts of a slip and the stick before it, in the order of time.
enum class SlipPart { kRise, kPeak, kFall, kTrough };
inline constexpr std::array<std::string_view, 4> kSlipPartNames{"rise", "peak", "fall", "trough"};

/// Residuals of a test's fits compared with the noise of a scan, by their size and by what repeats in each
/// slip.
class Misfit {
 public:
  /// Adds the residuals of a section's fit. Of a fit that did not converge only their size counts; one that
  /// did not begin adds nothing.
  /// \param sigma  noise of one scan.
  void add(const estimate::Trace& trace, const SlipEstimates& estimates, double sigma);
  /// Adds the residuals of other sections.
  void add(const Misfit& others) noexcept;

  /// Standard deviation of the residuals, in σ; 1 for noise alone, 0 without a fit.
  [[nodiscard]] double residual_sigmas() const noexcept { return residual_of(whole_); }
  /// Standard deviation of the residuals in one part of the slips, in σ, over the sections whose fit
  /// converged and left significantly large ones; 0 if none. The fall is from 90 to 10 % of the drop.
  [[nodiscard]] double residual_sigmas(SlipPart part) const noexcept {
    return residual_of(parts_[static_cast<std::size_t>(part)]);
  }
  /// Part with the largest residuals; nullopt unless their size is significant in the whole test and in a
  /// section, and every fit converged.
  [[nodiscard]] std::optional<SlipPart> place() const noexcept;
  /// Systematic residual, in σ, with its standard error: √(residual² − 1), at least 0; if repeats(), the root
  /// of MeanResidual::square() where that is more. Absent if a fit did not converge, or without a fit.
  [[nodiscard]] Estimate systematic() const;
  /// Whether the size of the residuals, or what repeats in each slip, is larger than chance makes it in 1 %
  /// of the tests.
  [[nodiscard]] bool is_significant() const noexcept {
    return std::max(z_of(whole_), z_of_mean()) > kSignificant;
  }
  /// is_large() or repeats().
  [[nodiscard]] bool is_certain() const noexcept { return is_large() || repeats(); }
  /// Whether the size of the residuals is larger than chance makes it in 3 of 10⁵ tests.
  [[nodiscard]] bool is_large() const noexcept { return z_of(whole_) > kCertain; }
  /// Whether what repeats in each slip is larger than chance makes it in 3 of 10⁵ tests.
  [[nodiscard]] bool repeats() const noexcept { return z_of_mean() > kCertain; }
  [[nodiscard]] const MeanResidual& mean() const noexcept { return mean_; }
  /// Error that what repeats in each slip adds to a fit, in units of the fit's errors: √(ratio² − 1), with
  /// Birge's ratio over the size of the residuals, which these errors contain already. 0 unless what repeats
  /// is significant at 1 %.
  [[nodiscard]] double beyond_noise() const noexcept;

 private:
  struct Sum {
    double squares = 0.0;  ///< In σ², times the degrees of freedom.
    double freedom = 0.0;
    void add(double residual_sigma, double of_freedom) noexcept;
    void add(const Sum& other) noexcept;
  };
  static constexpr double kSignificant = 2.326;
  static constexpr double kCertain = 4.0;
  [[nodiscard]] static double residual_of(const Sum& sum) noexcept;
  /// Deviation of a mean square from 1, in standard errors of its own and of σ, which is itself estimated.
  [[nodiscard]] static double z_of(const Sum& sum) noexcept;
  [[nodiscard]] double z_of_mean() const noexcept { return mean_.z(whole_.freedom); }

  bool converged_ = true;
  Sum whole_;
  MeanResidual mean_;
  std::array<Sum, kSlipPartNames.size()> parts_;
};

/// Fills mu_s, mu_k, delta_mu, omega, gamma_over_2omega, Q, Q_threshold, threshold_speed,
/// slip_speed_ratio_threshold, amplitude and delta_mu_scatter, each with its standard error or the reason why
/// it is absent; calls escape_results(). S and K include the drift. S, K and S − K are those of
/// estimates.uniform, or else means over the slips that began from sticking, without those whose error of
/// S − K exceeds the median |S − K|, unless all do. Of three or more, the first and those after a hold
/// are left out, too, unless estimates.first_counts or no other is left. Where neighbouring slips are
/// correlated, the standard errors of these means are those of means that wander.
///
/// The systematic uncertainty of S and S − K is γ v/g: whether the damper's force counts at the slip onset is
/// a convention that no trace can decide (here: spring only, [Penner 1995, (13)]). If no slip stuck again,
/// creep of the contact at 5 % of the belt's speed adds to it. If misfit.beyond_noise() is not 0, all that
/// follows from the fit's parameters has a part for it.
///
/// If model_describes() is false, all of these are absent but the amplitude, then half the mean drop of
/// `slips`; so are pull_speed_measured and the results of feature_results(). Q, Q_threshold and
/// threshold_speed are absent if S − K is not positive, the latter two also if γ is not positive; Q and
/// slip_speed_ratio_threshold unless estimates.belt.has_one_speed(); delta_mu_scatter with fewer than three
/// slips that are not left out.
/// \param misfit  of this section.
/// \param tester  only its gravity is read.
/// \param sigma  noise of one scan.
void model_results(std::span<const detect::Fall> slips, const SlipEstimates& estimates, const Misfit& misfit,
                   const model::Tester& tester, double sigma, TestResults& results);

/// Fills escape_speed and escape_speed_corrected by escape_speeds(). Both are absent, with the reason, on a
/// constant belt, if γ is not positive, and if delta_mu_scatter() is nullopt.
/// \param estimates  converged.
void escape_results(const SlipEstimates& estimates, TestResults& results);

/// Sets pull_speed_measured and the results of model_results() and feature_results() to absent, with
/// `reason`.
void no_model_results(const std::string& reason, TestResults& results);

/// Table of cycles, one row for each slip. The first of `slips` has number 0; it and those after a hold have
/// kCycleIsFirst. Onset, capture, stick and slip times, S − K, slip_speed_ratio and pull speed are NaN where
/// the fit did not converge, and for a slip that did not begin from sticking or has no window; capture and
/// slip time also unless it ended in sticking, stick time also unless its beginning is known, pull speed also
/// on a constant belt.
/// The caller sets first_scan, the evidence of capture, and the flags for spikes, gaps and saturation.
[[nodiscard]] std::vector<detect::Cycle> cycle_table(const estimate::Trace& trace,
                                                     std::span<const detect::Fall> slips,
                                                     const SlipEstimates& estimates);

}  // namespace stickslip::analysis
