/// \file
/// Systematic uncertainty of coefficients from an offset of the zero.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"

namespace stickslip::pipeline {

/// If the unloaded cell read more than UnloadedLevel::kNearest before or after the test, adds a finding, and
/// adds the larger of the two levels in quadrature to the systematic uncertainty of each coefficient that it
/// shifts; if it read less, notes that the zero adds nothing. Differences such as S − K, amplitudes, times
/// and frequencies are not affected. Values are not changed. \param before,after  levels as coefficients;
/// nullopt if unknown.
void add_zero_offset(analysis::TestResults& results, std::optional<double> before,
                     std::optional<double> after);

}  // namespace stickslip::pipeline
