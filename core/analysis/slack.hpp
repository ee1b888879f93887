/// \file
/// Where the coupling went slack. It pulls and cannot push: a sled that runs ahead of the belt leaves the
/// force at that of the unloaded cell, where no slip follows [2], and with S and K a force below zero.
#pragma once

#include <cstddef>
#include <string>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Number of slips whose trough lies within four standard deviations of the force before the pull, or of zero
/// where the trace begins under load. The last slip does not count: the pull may have ended in it. \param
/// sigma noise of a scan.
[[nodiscard]] std::size_t count_slack(const estimate::Trace& trace,
                                      const base::LongColumn<detect::Fall>& slips, double sigma);

/// Why no fit of the model is made. \param slack_count > 0.
[[nodiscard]] std::string why_slack(std::size_t slack_count, std::size_t slip_count);

/// Takes away what turning points do not tell where the trough of a slip is that of a slack coupling: K and
/// S − K, and in a free oscillation S and not K, which the slips without slack tell.
void void_slack_turns(const std::string& why, model::Regime regime, TestResults& results);

/// Code kSlack.
[[nodiscard]] base::Finding slack_finding(std::size_t slack_count, std::size_t slip_count);

}  // namespace stickslip::analysis
