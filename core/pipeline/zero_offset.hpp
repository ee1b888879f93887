/// \file
/// Systematic uncertainty of coefficients from an offset of the zero.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"

namespace stickslip::pipeline {

/// Adds the offset of the zero to the results. If the unloaded cell was off by more than
/// UnloadedLevel::kNearest before or after the test, adds a finding, and the larger offset, in quadrature, to
/// the systematic uncertainty of S, K, the static and the kinetic coefficient. If it was not, notes that the
/// zero adds nothing; if neither level is known, does nothing. Values do not change, nor do differences such
/// as S − K, amplitudes, times and frequencies.
/// \param before,after  levels as coefficients; nullopt, or not finite, if unknown.
void add_zero_offset(analysis::TestResults& results, std::optional<double> before,
                     std::optional<double> after);

}  // namespace stickslip::pipeline
