/// \file
/// All slips of a test, however many: a long test is estimated in sections of so many slips that their fit
/// needs little memory, and what the sections say is put together. Most tests are one section.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/analysis/characterisation.hpp"
#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/cycle.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/tester.hpp"

namespace stickslip::analysis {

/// Slips whose ω, γ and stick rate are found together: of a minute of stick and slip at the least. Of so many
/// slips the three are known ten times better than each slip's own numbers, which gain nothing from more.
inline constexpr std::size_t kMostSlipsTogether = 1024;

struct TestEstimates {
  /// Those of model_results() and feature_results() only. Of several sections the mean, weighted by their
  /// slips; nothing where one section has nothing.
  TestResults results;
  base::LongColumn<double> log_likelihood_ratios;  ///< Captured over free, one fewer than slips.
  base::LongColumn<detect::Cycle> cycles;          ///< One for each slip, as from cycle_table().
  base::LongColumn<double> onset_errors_s;  ///< Standard error of each onset; NaN where it is not known.
  std::int64_t captured = 0;                ///< Slips that ended in sticking.
  bool model_describes = true;              ///< Each section.
  /// What the test says about the tester; nothing if the fit of a section did not converge.
  std::optional<TesterEstimate> tester;
};

/// \param slips  falls that are slips, in the order of time, not empty. \param sigma  noise of one scan, > 0.
/// \param scratch  folder for the columns of a long test; empty: memory.
/// \param most  slips of a section, > 2. \param first_counts  the first slip of the test counts in means.
[[nodiscard]] TestEstimates estimate_in_sections(const estimate::Trace& trace,
                                                 const base::LongColumn<detect::Fall>& slips, double sigma,
                                                 const estimate::SharedPrior& prior,
                                                 const model::Tester& tester,
                                                 const std::filesystem::path& scratch = {},
                                                 std::size_t most = kMostSlipsTogether,
                                                 bool first_counts = false);

}  // namespace stickslip::analysis
