/// \file
/// What the clocks say about the scan rate of a test, as a result.
#pragma once

#include <span>

#include "core/analysis/results.hpp"
#include "core/daq/clock_anchor.hpp"
#include "core/daq/gap.hpp"

namespace stickslip::pipeline {

/// Sets `scan_rate_measured`, and adds a finding where the rate is not the granted one: by which factor all
/// that has a time in it is wrong, for results use the granted rate, so that the same scans give the same
/// results wherever they are analysed.
/// \param anchors,gaps  of the test, both rising; without anchors nothing changes.
void add_true_rate(analysis::TestResults& results, std::span<const daq::ClockAnchor> anchors,
                   std::span<const daq::Gap> gaps, double granted_Hz);

}  // namespace stickslip::pipeline
