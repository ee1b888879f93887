/// \file
/// process/estimator: by which estimator the numbers of a record were made.
#pragma once

#include "core/base/result.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// An empty field is "fit", the default. Error: kUsage, a word that is no estimator.
[[nodiscard]] base::Result<detect::EstimatorTier> estimator_of(const ProcessFacts& process);

/// Version 0.1 wrote the estimator into the text of the method, "penner-1995 kinetic_cycles=10
/// estimator=peak", unless it was "fit". Moves it from there into its field, if that is empty; what is no
/// estimator stays where it is. For readers of files: whatever comes after them knows the field alone. It can
/// go with the version that no longer reads records of format version 2 (kOldestFormatVersion).
void read_estimator_of_0_1(ProcessFacts& process);

}  // namespace stickslip::record
