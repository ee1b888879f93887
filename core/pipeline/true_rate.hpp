/// \file
/// Scan rate of a test by the clock, as a result.
#pragma once

#include <span>

#include "core/analysis/results.hpp"
#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::pipeline {

/// Sets `scan_rate_measured`, with a systematic uncertainty of 100 ppm by the computer's clock; absent with a
/// reason if there are too few anchors that were not read late. If it differs from the granted rate by more
/// than 100 ppm and five standard errors, adds a finding with the factor by which all times are wrong. Other
/// results are not corrected: they use the granted rate, so that the same scans always give the same results.
/// \param anchors,gaps  of the test, both rising; without anchors the results are unchanged.
void add_true_rate(analysis::TestResults& results, std::span<const daq::ClockAnchor> anchors,
                   std::span<const daq::Gap> gaps, double granted_Hz);

}  // namespace stickslip::pipeline
