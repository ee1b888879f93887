/// \file
/// From the falls that are slips to the parameters of the model: which slips were captured, and
/// S, K, ω, γ and the stick rate that fit the whole test best.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/analysis/characterisation.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/slip_fit.hpp"
#include "core/estimate/trace.hpp"
#include "core/estimate/uniform_fit.hpp"

namespace stickslip::analysis {

/// How a slip ended.
enum class SlipEnd {
  kCaptured,  ///< In sticking.
  kFree,      ///< The oscillation went on without sticking.
  kUnknown,   ///< The trace, the pull or what is known of it ended first.
};

struct SlipEstimates {
  /// It is not the model's: the pull ended in this slip, the last one, or it follows a gap, and how it began
  /// is not known.
  static constexpr std::size_t kNoWindow = static_cast<std::size_t>(-1);

  estimate::Drift drift;                      ///< Of the trace: fitted S and K are without it.
  std::vector<SlipEnd> ends;                  ///< One for each slip.
  std::vector<double> log_likelihood_ratios;  ///< Captured over free, one fewer than slips; 0 if unknown.
  std::vector<estimate::SlipWindow> windows;  ///< One for each onset from sticking.
  std::vector<std::size_t> window_of_slip;    ///< Index into `windows` for each slip, or kNoWindow.
  estimate::SlipFit fit;
  /// One S and one K for all slips but the first; nothing where the slips differ by more than noise.
  std::optional<estimate::UniformFit> uniform;
  model::BeltCourse belt;     ///< Of the trace.
  bool first_counts = false;  ///< The first slip counts in means like the others.

  [[nodiscard]] bool has_window(std::size_t slip) const noexcept { return window_of_slip[slip] != kNoWindow; }

  /// What the fit that counts says about the tester. Only if fit.converged.
  [[nodiscard]] TesterEstimate tester() const;
  /// S of a slip: c at its onset, with what friction gives beside it to take the sled along with an
  /// accelerating belt, a/g.
  [[nodiscard]] double static_coefficient(const estimate::SlipWindow& window) const;
};

/// \param slips  falls that are slips, in the order of time, not empty.
/// \param sigma  noise of one scan, > 0.
/// \param prior  what is known of ω, γ and the stick rate beforehand.
/// \param first_counts  the first slip counts in means, and must agree with the others for `uniform`.
[[nodiscard]] SlipEstimates estimate_slips(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                           double sigma, const estimate::SharedPrior& prior = {},
                                           bool first_counts = false);

}  // namespace stickslip::analysis
