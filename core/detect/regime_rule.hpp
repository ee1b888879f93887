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
  std::size_t told = 0;  ///< Slips that tell how they ended.
  /// Of those the ones that ended in sticking, in the likeliest course of the regime: none in one that never
  /// sticks, whatever a slip by itself looks like. Absent: the regime is that of the cycles' shape, or
  /// undecided.
  std::optional<std::size_t> captured;
};

/// Likelihood ratio of the best two regimes below which the result is undecided.
inline constexpr double kDecisiveLikelihoodRatio = 20.0;

/// How well the model describes a test.
enum class Description {
  kFits,
  kDoubtful,  ///< No fit describes it, but its residuals are noise: only slips that agree tell a regime.
  kRefuted,   ///< The residuals are certainly more than noise: another friction.
};

/// \param slip_count  slips of the test.
/// \param log_likelihood_ratios  captured over free, one for each slip but the last.
/// \param description  of the trace by the model on which the ratios rest. If it is refuted each ratio counts
/// for little.
///
/// In a mixed course each change of behaviour costs ln(n − 1), n being the slips that tell: it may be between
/// any two of them. If the model is refuted it costs ln 100 at least.
[[nodiscard]] RegimeVerdict judge_regime(std::size_t slip_count,
                                         const base::LongColumn<double>& log_likelihood_ratios,
                                         Description description);

/// What the cycles of a test look like, without any model.
struct CycleShape {
  std::size_t count = 0;        ///< Cycles with a rise after the fall.
  double rise_over_fall = 0.0;  ///< Median: time from trough to next peak over time from peak to trough.
  double decay_sigmas = 0.0;    ///< Decrease of the logarithm of the drop with time, in standard errors.
};

/// Regime of a test that no friction law describes, or only with misfit. The rises of a sled that never rests
/// take as long as its falls, those of one that rests longer; only a free oscillation decays.
///
/// \param by_ends  from judge_regime(); stays for decaying and for few cycles, and where it agrees.
/// \param model_describes  by_ends stays, too, unless it is undecided and the sled rests.
[[nodiscard]] RegimeVerdict judge_by_shape(const CycleShape& shape, RegimeVerdict by_ends,
                                           bool model_describes);

}  // namespace stickslip::detect
