/// \file
/// Systematic uncertainty of coefficients from the gain of the load cell.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"
#include "core/daq/calibration.hpp"

namespace stickslip::pipeline {

/// Standard error of the gain over the gain, ≥ 0; nullopt if either is unknown.
[[nodiscard]] std::optional<double> relative_gain_uncertainty(const std::optional<daq::LoadCell>& load_cell,
                                                              std::optional<double> standard_error_N_per_V);

/// Adds `relative` times the value, in quadrature, to the systematic uncertainty of the results that depend
/// on the gain: static and kinetic coefficient, S, K, S − K and its scatter, amplitude, drift, threshold
/// speed, Q, and the pull speed from the sticks; smallest_slip is left out. Times, counts, frequencies,
/// damping and escape speeds do not depend on it. Does nothing if `relative` is nullopt.
void add_gain_uncertainty(analysis::TestResults& results, std::optional<double> relative);

}  // namespace stickslip::pipeline
