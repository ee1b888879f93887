/// \file
/// What a zero that is off leaves open in the coefficients of a test.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"

namespace stickslip::pipeline {

/// Where the unloaded cell read more than UnloadedLevel::kNearest before or after the test, says so in the
/// findings, and adds the worse of the two in quadrature to the systematic uncertainty of each coefficient
/// that it shifts. Differences such as S − K, amplitudes, times and frequencies keep theirs: a zero shifts
/// both of their ends. No value changes. \param before,after  as coefficients; absent where they are not
/// known: then nothing is added.
void add_zero_offset(analysis::TestResults& results, std::optional<double> before,
                     std::optional<double> after);

}  // namespace stickslip::pipeline
