/// \file
/// What spikes, drift and the first slip did to the results of a record: `stickslip analyze --effects`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/analysis/results.hpp"
#include "core/analysis/skipped_corrections.hpp"
#include "core/base/result.hpp"
#include "core/estimate/shared_prior.hpp"
#include "core/record/record.hpp"

namespace stickslip::cli {

struct Effect {
  analysis::SkippedCorrections skipped;
  analysis::TestResults results;
};

/// The record analysed with all corrections, and without each of analysis::kCorrectionNames in turn, in this
/// order.
/// \param prior  as analyse_with_tester(). Errors: as there.
[[nodiscard]] base::Result<std::vector<Effect>> effects_of(record::Record record,
                                                           const estimate::SharedPrior& prior);

/// A table of S, K, S − K and the traditional static coefficient, with the change of S − K by each skipped
/// correction.
/// \param effects  of effects_of().
[[nodiscard]] std::string effects_text(std::span<const Effect> effects);

/// [{"kept": "", "regime": …, "mu_s": …, "mu_s_standard_error": …, "mu_k": …, "delta_mu": …,
///   "static_coefficient": …}, {"kept": "spikes", …}, …]; null where absent.
[[nodiscard]] nlohmann::ordered_json effects_json(std::span<const Effect> effects);

}  // namespace stickslip::cli
