/// \file
/// Bootstrap of a test: how its results scatter if its slips are drawn again. [Efron, Ann. Statist. 7:1–26,
/// 1979]
///
///     const Bootstrap drawn = bootstrap_slips(trace, estimates, sigma, prior, {.count = 1000});
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/analysis/slip_estimator.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

struct BootstrapSettings {
  std::size_t count = 0;   ///< Times that the slips are drawn; 0: no bootstrap.
  std::uint64_t seed = 1;  ///< Of the random numbers.
};

/// How one result scatters over the drawings.
struct BootstrapSpread {
  std::string_view name;  ///< As in a record.
  std::string_view unit;
  double standard_deviation = 0.0;
  double lowest = 0.0;   ///< 2.5 % of the drawings are below.
  double highest = 0.0;  ///< 2.5 % are above.
};

struct Bootstrap {
  BootstrapSettings settings;
  std::size_t converged = 0;             ///< Drawings whose fit converged; the others are left out.
  std::size_t block = 0;                 ///< Slips that are drawn together.
  std::vector<BootstrapSpread> spreads;  ///< S, K, S − K, ω and γ/2ω; empty if there are none.
  std::string reason;                    ///< Why there are none.
};

/// None, with a reason.
[[nodiscard]] inline Bootstrap no_bootstrap(const BootstrapSettings& settings, std::string reason) {
  return {settings, 0, 0, {}, std::move(reason)};
}

/// Draws as many slips as the means count, with replacement, and fits them anew, as the test was fitted: with
/// one S and K if SlipEstimates::uniform is present, else slip by slip. Neighbours are drawn in blocks of
/// ∛n slips [Hall, Horowitz and Jing, Biometrika 82:561–574, 1995] on a circle, since levels wander. The
/// prior's means are drawn anew, too. The drift is that of the test: its uncertainty is not in the scatter.
/// \param estimates  of the whole test; converged.
/// \param prior  with which it was fitted.
/// \param settings  count > 0 (contract).
/// \return without spreads, but with a reason: if fewer than eight slips count, if trace.belt is not
/// constant, or if fewer than nine drawings in ten converge.
[[nodiscard]] Bootstrap bootstrap_slips(const estimate::Trace& trace, const SlipEstimates& estimates,
                                        double sigma, const estimate::SharedPrior& prior,
                                        const BootstrapSettings& settings);

}  // namespace stickslip::analysis
