/// \file
/// What the load cell's calibration leaves open in every coefficient of a test alike.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"
#include "core/daq/calibration.hpp"

namespace stickslip::pipeline {

/// Standard error of the gain over the gain; nothing where either is not known.
[[nodiscard]] std::optional<double> relative_gain_uncertainty(const std::optional<daq::LoadCell>& load_cell,
                                                              std::optional<double> standard_error_N_per_V);

/// Adds it in quadrature to the systematic uncertainty of each result that is a force over the sled's weight.
/// Times, counts, frequencies, damping and speeds do not depend on the gain.
void add_gain_uncertainty(analysis::TestResults& results, std::optional<double> relative);

}  // namespace stickslip::pipeline
