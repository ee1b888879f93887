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

/// Largest residual in units of the scan noise up to which the model counts as describing the trace.
inline constexpr double kLargestResidualSigmas = 5.0;

/// Whether the fit converged, its residuals agree with the noise of the scans, its damping is neither
/// significantly negative nor overdamped, and no slip ended otherwise than its numbers say.
[[nodiscard]] bool model_describes(const SlipEstimates& estimates, double sigma);

/// Parts of a slip and the stick before it, in the order of time.
enum class SlipPart { kRise, kPeak, kFall, kTrough };
inline constexpr std::array<std::string_view, 4> kSlipPartNames{"rise", "peak", "fall", "trough"};

/// Residuals of a test's fits compared with the noise of a scan, by their size and by what repeats in each
/// slip.
class Misfit {
 public:
  /// Adds the fit of a section, or where it stopped. \param sigma  noise of one scan.
  void add(const estimate::Trace& trace, const SlipEstimates& estimates, double sigma);
  /// Adds that of other sections.
  void add(const Misfit& others) noexcept;

  /// Standard deviation of the residuals, in σ; 1 for noise alone.
  [[nodiscard]] double residual_sigmas() const noexcept { return residual_of(whole_); }
  /// The same over one part of the slips; 0 unless the misfit of a section is significant. The fall is from
  /// 90 to 10 % of the drop.
  [[nodiscard]] double residual_sigmas(SlipPart part) const noexcept {
    return residual_of(parts_[static_cast<std::size_t>(part)]);
  }
  /// Part with the largest residuals; nullopt unless their size is significant.
  [[nodiscard]] std::optional<SlipPart> place() const noexcept;
  /// Systematic residual, in σ, with its standard error: √(residual² − 1), or what repeats if that is more.
  [[nodiscard]] Estimate systematic() const;
  /// Whether size or repetition are larger than chance makes them, each in 1 % of the tests.
  [[nodiscard]] bool is_significant() const noexcept {
    return std::max(z_of(whole_), z_of_mean()) > kSignificant;
  }
  /// The same, in 3 of 10⁵ tests each.
  [[nodiscard]] bool is_certain() const noexcept { return is_large() || repeats(); }
  [[nodiscard]] bool is_large() const noexcept { return z_of(whole_) > kCertain; }
  [[nodiscard]] bool repeats() const noexcept { return z_of_mean() > kCertain; }
  [[nodiscard]] const MeanResidual& mean() const noexcept { return mean_; }
  /// √(ratio² − 1) by Birge's ratio: what repeats adds to errors, which hold the size of the residuals
  /// already; 0 unless significant.
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
/// slip_speed_ratio_threshold, amplitude
/// and delta_mu_scatter, each with its standard error, or the reason why it is absent. Where neighbouring
/// slips are correlated the standard errors of S, K and S − K are those of means that wander. The systematic
/// uncertainty of S and S − K is γ v/g: whether the damper's force counts at the slip onset is a convention
/// that no trace can decide (here: spring only, [Penner 1995, (13)]). What repeats in each slip adds to the
/// systematic uncertainty of what follows from the fit's parameters, and where no slip sticks again the creep
/// before it to that of S and S − K. \param misfit  of this section. \param sigma  noise of one scan.
void model_results(std::span<const detect::Fall> slips, const SlipEstimates& estimates, const Misfit& misfit,
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
