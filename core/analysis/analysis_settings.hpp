/// \file
/// What an analysis of one test is told.
#pragma once

#include <filesystem>
#include <optional>

#include "core/analysis/bootstrap.hpp"
#include "core/analysis/skipped_corrections.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/model/method.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

struct AnalysisSettings {
  double scan_rate_Hz = 350.0;    ///< Granted; > 0.
  double step_coefficient = 0.0;  ///< One A/D step; 0 if unknown, then estimated from the trace.
  model::Tester tester;
  model::Method method;
  /// Estimator of S, K and S − K, of each cycle and of the test. Only kFit fits the whole test at its end.
  /// With the other, where the fit does not describe the test, and where the coupling went slack, results
  /// come from cycles by turning points: no ω, no γ and no result that needs them.
  detect::EstimatorTier estimator = detect::EstimatorTier::kFit;
  estimate::SharedPrior prior;  ///< Of the tester's parameters; may be empty.
  SkippedCorrections skipped;   ///< Corrections to leave out, to show their effect.
  /// Folder for scratch files that hold the scans of a long test except the latest few minutes; empty: all in
  /// memory.
  std::filesystem::path scratch_folder;
  /// Whether add() detects slips. If not, finish() does, on a thread of its own beside the fits: for scans
  /// that are all there already.
  bool live = true;
  BootstrapSettings bootstrap;  ///< Of the results, at the end.
  /// One A/D step of the measured pull speed, ≥ 0; nullopt: no speed channel, speed() is not called.
  std::optional<double> speed_step_m_per_s;
};

}  // namespace stickslip::analysis
