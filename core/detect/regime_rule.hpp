/// \file
/// Regime of a test, from the likelihood ratios of its slips' ends.
#pragma once

#include <optional>
#include <string>

#include "core/base/long_column.hpp"
#include "core/model/regime.hpp"

namespace stickslip::detect {

struct RegimeVerdict {
  model::Regime regime = model::Regime::kUndecided;
  std::string reason;
  /// mixed only: the first slip after which the other behaviour began.
  std::optional<std::size_t> transition_slip;
};

/// Likelihood ratio of the best two regimes below which the result is undecided.
inline constexpr double kDecisiveLikelihoodRatio = 20.0;

/// \param slip_count  slips of the test.
/// \param log_likelihood_ratios  captured over free, one for each slip but the last.
/// \param model_describes  the ratios rest on a model that fits the trace; if it does not, only a
///        unanimous vote counts.
[[nodiscard]] RegimeVerdict judge_regime(std::size_t slip_count,
                                         const base::LongColumn<double>& log_likelihood_ratios,
                                         bool model_describes);

}  // namespace stickslip::detect
