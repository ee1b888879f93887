/// \file
/// What a zero that is off leaves open in the coefficients of a test.
#pragma once

#include <optional>

#include "core/friction/results.hpp"

namespace stickslip::pipeline {

/// Where the unloaded cell read more than UnloadedLevel::kNearest before the test, says so in the findings,
/// and adds what it read in quadrature to the systematic uncertainty of each coefficient that it shifts.
/// Differences such as S − K, amplitudes, times and frequencies keep theirs: a zero shifts both of their
/// ends. No value changes. \param unloaded_level  as a coefficient; absent where nobody knows it: then
/// nothing is added.
void add_zero_offset(friction::TestResults& results, std::optional<double> unloaded_level);

}  // namespace stickslip::pipeline
