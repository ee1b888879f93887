/// \file
/// Fits of a whole test: the highest rung that describes it, with a stated transducer taken off, the slope of
/// friction with speed, and slips drawn again.
///
///     TestFit fit{settings};
///     const TestEstimates estimates = fit.estimate(trace, slips, sigma, [] {});
#pragma once

#include <functional>
#include <optional>

#include "core/analysis/analysis_settings.hpp"
#include "core/analysis/bootstrap.hpp"
#include "core/analysis/characterisation.hpp"
#include "core/analysis/results.hpp"
#include "core/analysis/sections.hpp"
#include "core/analysis/transducer_correction.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// One test. Before estimate() it knows nothing of the tester.
class TestFit {
 public:
  /// \param settings  must outlive this.
  explicit TestFit(const AnalysisSettings& settings) : settings_(settings) {}
  explicit TestFit(AnalysisSettings&&) = delete;

  /// From the highest rung of the fit that describes the test; if none does, what the fit left. With a
  /// characterised tester γ is the tester's, unless the test alone contradicts it. Sets the trace's drift,
  /// and takes a stated transducer off its values. Call once.
  /// \param not_enough  not empty; called once at most, as soon as the fit is likely to need turning points.
  [[nodiscard]] TestEstimates estimate(estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                                       double sigma, const std::function<void()>& not_enough);
  /// μ′ of the paper over that of the characterisation, from the damping that the test alone has; why it has
  /// no value where estimate() was not called, or found no tester.
  /// \param estimates  the ones that the results come from.
  [[nodiscard]] Estimate mu_slope(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                                  double sigma, const TestEstimates& estimates) const;
  /// By settings.bootstrap, whose count is > 0; without spreads, but with a reason, where no fit describes
  /// the test, a transducer is off, or the slips are more than kMostSlipsTogether.
  [[nodiscard]] Bootstrap bootstrap(const estimate::Trace& trace, double sigma,
                                    const TestEstimates& estimates) const;

  /// The tester's parameters from this test alone, without settings.prior; nullopt unless such a fit
  /// describes the test.
  [[nodiscard]] const std::optional<TesterEstimate>& tester() const noexcept { return tester_; }
  /// Check against settings.prior.coupling; nullopt without it, without tester(), or if the fit with that
  /// prior did not converge.
  [[nodiscard]] const std::optional<TesterCheck>& tester_check() const noexcept { return tester_check_; }
  /// Whether what a stated transducer adds was taken off the trace.
  [[nodiscard]] bool took_transducer_off() const noexcept { return transducer_is_off_; }

 private:
  [[nodiscard]] SectionSettings section_settings() const;
  /// Takes off the trace what the transducer adds to the slips, and replaces `estimates`, which are those of
  /// the trace, by those without it. \return what errors of fits to the trace are to be multiplied by;
  /// nullopt, with nothing changed, where the slips are more than ThroughTransducer::kMostSlips or the rounds
  /// do not settle.
  [[nodiscard]] std::optional<ErrorFactors> take_off_transducer(estimate::Trace& trace,
                                                                const base::LongColumn<detect::Fall>& slips,
                                                                double sigma, TestEstimates& estimates) const;

  const AnalysisSettings& settings_;
  std::optional<TesterEstimate> tester_;
  std::optional<TesterCheck> tester_check_;
  bool transducer_is_off_ = false;
};

}  // namespace stickslip::analysis
