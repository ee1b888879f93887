/// \file
/// Results with standard errors, and the table of cycles, from the fitted slips.
#pragma once

#include <span>
#include <vector>

#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/detect/cycle.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

/// Largest residual in units of the scan noise up to which the model counts as describing the trace.
inline constexpr double kLargestResidualSigmas = 5.0;

/// Whether the fit converged, its residuals agree with the noise of the scans, its damping is neither
/// significantly negative nor overdamped, and no slip ended otherwise than its numbers say.
[[nodiscard]] bool model_describes(const SlipEstimates& estimates, double sigma);

/// Residuals of a test's fits compared with the noise of a scan.
class Misfit {
 public:
  /// Adds the fit of a section. \param sigma  noise of one scan.
  void add(const SlipEstimates& estimates, double sigma) noexcept;

  /// Standard deviation of the residuals, in σ; 1 for noise alone.
  [[nodiscard]] double residual_sigmas() const noexcept;
  /// Deviation of its square from 1, in standard errors of residuals and of σ, which is itself estimated.
  [[nodiscard]] double z() const noexcept;
  /// Chance exceeds it in 1 % of the tests.
  [[nodiscard]] bool is_significant() const noexcept { return z() > 2.326; }
  /// Chance exceeds it in 3 of 10⁵ tests.
  [[nodiscard]] bool is_certain() const noexcept { return z() > 4.0; }

 private:
  double squares_ = 0.0;  ///< In σ², times the degrees of freedom.
  double freedom_ = 0.0;
};

/// Fills mu_s, mu_k, delta_mu, omega, gamma_over_2omega, Q, Q_threshold, threshold_speed,
/// slip_speed_ratio_threshold, amplitude
/// and delta_mu_scatter, each with its standard error, or the reason why it is absent. The systematic
/// uncertainty of S and S − K is γ v/g: whether the damper's force counts at the slip onset is a convention
/// that no trace can decide (here: spring only, [Penner 1995, (13)]).
/// \param sigma  noise of one scan.
void model_results(std::span<const detect::Fall> slips, const SlipEstimates& estimates,
                   const model::Tester& tester, double sigma, TestResults& results);

/// Fills escape_speed and escape_speed_corrected. \param estimates  converged.
void escape_results(const SlipEstimates& estimates, TestResults& results);

/// Sets all results of model_results() to absent, with this reason.
void no_model_results(const std::string& reason, TestResults& results);

/// Table of cycles, one row for each slip. The caller sets the flags for spikes, gaps and saturation.
[[nodiscard]] std::vector<detect::Cycle> cycle_table(const estimate::Trace& trace,
                                                     std::span<const detect::Fall> slips,
                                                     const SlipEstimates& estimates);

}  // namespace stickslip::analysis
