/// \file
/// Estimates the model's parameters from the slips of a test: decides which slips were captured, and fits S,
/// K, ω, γ and the stick rate to the whole test.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/analysis/characterisation.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/estimate/slip_fit.hpp"
#include "core/estimate/trace.hpp"
#include "core/estimate/uniform_fit.hpp"

namespace stickslip::analysis {

/// How a slip ended.
enum class SlipEnd {
  kCaptured,  ///< In sticking.
  kFree,      ///< The oscillation went on without sticking.
  kUnknown,  ///< Not told. So is the last slip of each pull, as only the next fall tells, and a slip before a
             ///< break or with too few scans.
};

/// Result of estimate_slips().
struct SlipEstimates {
  /// Marks a slip without a window: the pull ended in it, or a break hides its beginning. Those after that
  /// one have none either, until a slip has ended in sticking or a pull begins.
  static constexpr std::size_t kNoWindow = static_cast<std::size_t>(-1);

  estimate::Drift drift;                      ///< Drift of the trace; fitted S and K are without it.
  std::vector<SlipEnd> ends;                  ///< One for each slip.
  std::vector<double> log_likelihood_ratios;  ///< Captured over free, one fewer than slips; 0 if unknown.
  std::vector<estimate::SlipWindow> windows;  ///< One for each onset from sticking but those with kNoWindow.
  std::vector<std::size_t> window_of_slip;    ///< Index into `windows` for each slip, or kNoWindow.
  estimate::SlipFit fit;
  model::SharedParameters guess;  ///< By turning points and slopes: where the first try began.
  /// Fit of one S and one K to all slips but the first (with it if first_counts). Nullopt if the slips differ
  /// by more than noise, a window is not SlipWindow::captured, there are fewer than three windows, `belt` is
  /// not constant, no periodic stick-slip has their means, or a fit did not converge.
  std::optional<estimate::UniformFit> uniform;
  model::BeltMotion belt;     ///< Trace::belt: relative speed; constant unless a change of it is known.
  bool first_counts = false;  ///< Means include the first slip and those after a hold.

  [[nodiscard]] bool has_window(std::size_t slip) const noexcept { return window_of_slip[slip] != kNoWindow; }

  /// The tester's parameters, from `uniform` if present, else from `fit`. Requires fit.converged.
  [[nodiscard]] TesterEstimate tester() const;
  /// S of a slip, without the drift: c at its onset plus a/g, the friction that gives the sled the belt's
  /// acceleration a.
  [[nodiscard]] double static_coefficient(const estimate::SlipWindow& window) const;
};

/// Prior for slips whose shape tells no γ. It holds γ/2ω at model::kTypicalGammaOver2Omega and leaves ω
/// nearly free: ± 50 % about π over the median time from peak to trough. It says nothing of the stick rate.
/// \param slips  not empty.
[[nodiscard]] estimate::SharedPrior held_damping(const estimate::Trace& trace,
                                                 const base::LongColumn<detect::Fall>& slips);

/// Decides how each slip ended and fits the model. Where no fit converges, `fit.converged` is false, and the
/// result is where the first try stopped.
/// \param slips  falls that are slips, in the order of time, not empty.
/// \param sigma  noise of one scan, > 0.
/// \param prior  of ω, γ and the stick rate.
/// \param first_counts  means include the first slip and those after a hold, and `uniform` the first.
[[nodiscard]] SlipEstimates estimate_slips(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                           double sigma, const estimate::SharedPrior& prior = {},
                                           bool first_counts = false);

}  // namespace stickslip::analysis
