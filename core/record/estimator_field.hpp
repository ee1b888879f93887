/// \file
/// process/estimator: by which estimator the numbers of a record were made.
#pragma once

#include "core/base/result.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Estimator that process.estimator names (detect::estimator_tier_from_name()); kFit if it is empty.
/// Errors: kUsage if the name is unknown.
[[nodiscard]] base::Result<detect::EstimatorTier> estimator_of(const ProcessFacts& process);

/// Moves an estimator's name, unchanged, from process.method, where version 0.1 wrote it ("penner-1995
/// kinetic_cycles=10 estimator=peak"), to process.estimator. That may then be a name of version 0.1, which
/// estimator_of() understands. Does nothing if there is none, the name is unknown, or that field is set.
/// Readers of files call it. It can be removed once format version 2 is no longer read
/// (kOldestFormatVersion).
void read_estimator_of_0_1(ProcessFacts& process);

}  // namespace stickslip::record
