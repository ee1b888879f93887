/// \file
/// Rules for the regime of a test: from the likelihood ratios of how its slips ended, and, where the model
/// does not describe it, from the shape of its cycles.
#pragma once

#include <optional>
#include <string>

#include "core/base/long_column.hpp"
#include "core/model/regime.hpp"

namespace stickslip::detect {

/// Regime of a test, with the reason.
struct RegimeVerdict {
  model::Regime regime = model::Regime::kUndecided;
  std::string reason;  ///< For people; never empty.
  /// kMixed only: index of the first slip that ended otherwise than the last before it that tells, in the
  /// likeliest course.
  std::optional<std::size_t> transition_slip;
  std::size_t told = 0;  ///< Slips that tell how they ended: log-likelihood ratio other than 0.
  /// How many of the slips that tell ended in sticking, in the likeliest course of the regime: 0 in a regime
  /// that never sticks, whatever a slip by itself looks like. Absent if undecided, or if stick-slip was found
  /// by the shape of the cycles.
  std::optional<std::size_t> captured;
};

/// Likelihood ratio of the best two regimes below which the result is undecided. Also how much likelier
/// than a capture a free oscillation must be where SlipFollower has to decide.
inline constexpr double kDecisiveLikelihoodRatio = 20.0;

/// How well the model describes a test.
enum class Description {
  kFits,
  kDoubtful,  ///< No fit describes it, but its residuals may be noise: only slips that agree tell a regime.
  kRefuted,   ///< The residuals are certainly more than noise: another friction.
};

/// Regime by how the slips ended: the likeliest of stick-slip, ring-down and mixed, if it is
/// kDecisiveLikelihoodRatio times as likely as the next; else undecided. Without a slip: steady sliding. If
/// no slip tells: undecided.
///
/// In a mixed course each change of behaviour costs ln(n − 1), n being the slips that tell: it may be between
/// any two of them. If the model is refuted it costs ln 100 at least.
/// \param slip_count  slips of the test.
/// \param log_likelihood_ratios  captured over free, one for each slip but the last; not NaN: 0 if it does
///        not tell.
/// \param description  of the trace by the model on which the ratios rest. If refuted, each ratio counts for
///        20 to 1 at most. If doubtful, slips that end differently leave the regime undecided.
[[nodiscard]] RegimeVerdict judge_regime(std::size_t slip_count,
                                         const base::LongColumn<double>& log_likelihood_ratios,
                                         Description description);

/// What the cycles of a test look like, without any model. With fewer than three cycles only count is set.
struct CycleShape {
  std::size_t count = 0;        ///< Cycles with a rise after the fall.
  double rise_over_fall = 0.0;  ///< Median: time from trough to next peak over time from peak to trough.
  double decay_sigmas = 0.0;    ///< Decrease of the logarithm of the drop with time, in standard errors.
};

/// Regime of a test that no friction law describes, or only with misfit. The rises of a sled that never rests
/// take as long as its falls, those of one that rests last longer; only a free oscillation decays.
/// \param by_ends  from judge_regime().
/// \param model_describes  some fit describes the test, if only with misfit.
/// \return by_ends with fewer than eight cycles, or if they decay by more than three standard errors.
/// Otherwise, if the rises are longer than 1.1 falls: stick-slip in place of undecided, or of a ring-down
/// that the model does not describe. If they are not: inertial oscillation unless the model describes the
/// test. Else by_ends.
[[nodiscard]] RegimeVerdict judge_by_shape(const CycleShape& shape, RegimeVerdict by_ends,
                                           bool model_describes);

}  // namespace stickslip::detect
