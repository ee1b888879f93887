/// \file
/// Estimates of a test with any number of slips. A long test is fitted in sections, which bounds memory, and
/// their results are combined. Most tests are one section.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/analysis/characterisation.hpp"
#include "core/analysis/model_results.hpp"
#include "core/analysis/results.hpp"
#include "core/analysis/slip_estimator.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/cycle.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/slip_model.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

/// Most slips of a section; they share ω, γ and stick rate. From so many slips, a minute of stick-slip, the
/// shared parameters are ten times more precise than those of each slip, which would gain nothing from more.
inline constexpr std::size_t kMostSlipsTogether = 1024;

/// A slip as fitted: what SlipModel needs, for the scans [first, end) of the trace.
struct FittedSlip {
  std::size_t first = 0;
  std::size_t end = 0;
  /// Fitted as ending in sticking. An unknown end counts as sticking, but not of a slip that follows a free
  /// one.
  bool captured = false;
  model::SlipParameters slip;
  model::SharedParameters shared;
};

/// Combined estimates of all sections; or those of estimates_from_live(), which says what it fills.
struct TestEstimates {
  /// Only the results of model_results() and feature_results(). Means over sections, weighted by their slips;
  /// absent if one section has no value, and all if the means do not tell S from K (model_describes is then
  /// false). S and S − K may be from the bound instead: estimate_in_sections().
  TestResults results;
  base::LongColumn<double> log_likelihood_ratios;  ///< Captured over free, one fewer than slips; 0: unknown.
  base::LongColumn<detect::Cycle> cycles;          ///< One for each slip, as from cycle_table().
  base::LongColumn<double> onset_errors_s;  ///< One for each slip: standard error of its onset; NaN: unknown.
  /// One for each onset from sticking, without slips that have no window (SlipEstimates::kNoWindow) and
  /// sections whose fit did not converge. Empty unless settings.keep_fitted.
  base::LongColumn<FittedSlip> fitted;
  std::int64_t captured = 0;  ///< Slips that ended in sticking.
  /// The model describes each section, S is not clearly below K, and, if slips stick, S − K exceeds its
  /// standard error.
  bool model_describes = true;
  Rung rung = Rung::kLawWithSlope;  ///< Set by the caller, with rung_reason.
  std::string rung_reason;          ///< Why not a higher rung.
  Misfit misfit;                    ///< Of all sections.
  /// The tester's parameters by the fits of all sections, the prior included; nullopt if the fit of a section
  /// did not converge.
  std::optional<TesterEstimate> tester;
  /// The estimates of a test of one section, and the prior with which it was fitted. Null of several, if the
  /// fit did not converge, and unless settings.keep_section.
  std::shared_ptr<const SlipEstimates> section;
  estimate::SharedPrior prior;
};

/// Settings of estimate_in_sections().
struct SectionSettings {
  std::filesystem::path scratch{};  ///< Folder for the columns of a long test; empty: memory.
  /// Most slips of a section, > 2. Where the pull speed changes, all slips are one section whatever this is.
  std::size_t most = kMostSlipsTogether;
  bool first_counts = false;  ///< Means include the first slip of the test and those after a hold.
  bool keep_fitted = false;   ///< Fills TestEstimates::fitted.
  bool keep_section = false;  ///< Fills TestEstimates::section.
  bool on_threads = false;    ///< Fits the next section beside this one; the estimates are the same.
};

/// Fits the slips section by section and combines the estimates. Where the model describes the test, S − K
/// that is not told from 0 is half of its bound, as by tell_bound(): if it is not positive, or if no slip
/// stuck and its standard error reaches half of the bound. The bound is S − K plus twice its total_error(),
/// or the amplitude if that is less.
/// \param slips  falls that are slips, in the order of time, not empty.
/// \param sigma  noise of one scan, > 0.
/// \param prior  of ω, γ and the stick rate; may be empty.
[[nodiscard]] TestEstimates estimate_in_sections(const estimate::Trace& trace,
                                                 const base::LongColumn<detect::Fall>& slips, double sigma,
                                                 const estimate::SharedPrior& prior,
                                                 const model::Tester& tester,
                                                 const SectionSettings& settings = {});

}  // namespace stickslip::analysis
