/// \file
/// Fits slips that are seen through a known transducer: takes off the trace what the transducer adds to them.
///
///     const ThroughTransducer through{transducer, 1.0 / 350.0, scratch_folder};
///     if (auto found = through.estimate(trace, seen, fit)) trace.value = through.force(trace, *found);
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/analysis/sections.hpp"
#include "core/base/long_column.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/transducer.hpp"

namespace stickslip::analysis {

/// One for each result, in the order of for_each_result(); empty: all are 1.
using ErrorFactors = std::vector<double>;

/// Multiplies the standard errors; those of the tester by the larger one of omega and gamma_over_2omega.
void widen_errors(const ErrorFactors& factors, TestEstimates& estimates);

class ThroughTransducer {
 public:
  /// Estimates of a trace, with TestEstimates::fitted.
  using Fit = std::function<TestEstimates(const estimate::Trace&)>;
  /// Slips of the longest test that is corrected, which callers check: some 20 fits of it take less time than
  /// the scans that wait for the end of a test may.
  static constexpr std::size_t kMostSlips = 4096;
  /// Slips from which the errors are learnt.
  static constexpr std::size_t kMostSlipsOfErrors = 128;

  /// \param interval_s  of scans, > 0. \param scratch_folder  of columns as long as the trace; empty: memory.
  ThroughTransducer(const model::Transducer& transducer, double interval_s,
                    std::filesystem::path scratch_folder)
      : transducer_(transducer), interval_s_(interval_s), scratch_folder_(std::move(scratch_folder)) {}

  /// The slips whose image through the transducer is the trace: those that are fitted to the trace less what
  /// the transducer adds to them, found in rounds. Times stay those of the trace, in which all is late by the
  /// transducer's lag.
  /// \param seen  fit(trace).
  /// \return the fit of the last round, whose model_describes may be false; nullopt if the rounds do not
  /// settle, `seen` has no fitted slips, or the lag is more than a fifth of an oscillation.
  [[nodiscard]] std::optional<TestEstimates> estimate(const estimate::Trace& trace, const TestEstimates& seen,
                                                      const Fit& fit) const;

  /// How much more estimate() scatters than fit(), of each result and at least 1, over traces of the first
  /// slips found with noise; the random stream is always the same. The transducer hides a part of the slips.
  /// \param found  of estimate(). \param sigma  noise of a scan. \param fit  of a trace that may end after
  /// kMostSlipsOfErrors slips. \return nullopt unless estimate() settles, and the fits describe the trace,
  /// with at least 8 of 12 other noises.
  [[nodiscard]] std::optional<ErrorFactors> error_factors(const estimate::Trace& whole,
                                                          const TestEstimates& found, double sigma,
                                                          const Fit& fit) const;

  /// The trace less what the transducer adds to these slips.
  [[nodiscard]] base::LongColumn<double> force(const estimate::Trace& trace,
                                               const TestEstimates& found) const;

 private:
  /// What the transducer shows of the fitted slips, less these slips themselves, at each scan: 0 before the
  /// first slip, after the last, and between slips far apart.
  [[nodiscard]] base::LongColumn<double> distortion(const estimate::Trace& trace,
                                                    const base::LongColumn<FittedSlip>& fitted) const;

  model::Transducer transducer_;
  double interval_s_;
  std::filesystem::path scratch_folder_;
};

}  // namespace stickslip::analysis
