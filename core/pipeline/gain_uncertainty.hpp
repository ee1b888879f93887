/// \file
/// Systematic uncertainty of coefficients from the gain of the load cell.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"
#include "core/daq/calibration.hpp"

namespace stickslip::pipeline {

/// Standard error of the gain over the gain; nullopt if either is unknown.
[[nodiscard]] std::optional<double> relative_gain_uncertainty(const std::optional<daq::LoadCell>& load_cell,
                                                              std::optional<double> standard_error_N_per_V);

/// Adds the relative gain uncertainty in quadrature to the systematic uncertainty of each result that is a
/// force over the sled's weight. Times, counts, frequencies, damping and speeds do not depend on the gain.
void add_gain_uncertainty(analysis::TestResults& results, std::optional<double> relative);

}  // namespace stickslip::pipeline
