/// \file
/// Where the coupling went slack. It pulls and cannot push: a sled that runs ahead of the belt leaves the
/// force at that of the unloaded cell. The law of a slip [2], which would give a force below zero, does not
/// hold there.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Range of the force at which the coupling is slack, and how many slips reach it. By default it is empty.
struct Slack {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  std::size_t count = 0;  ///< Slips with such a trough, but for the last slip of the test.

  /// Whether the slip ended in slack: the lowest of the five scans about its trough lies in the range. The
  /// interpolated trough may lie below it, at the corner of a fall into slack.
  [[nodiscard]] bool holds(const estimate::Trace& trace, const detect::Fall& slip) const noexcept;
};

/// The range is from 6 σ below to 4 σ above the force before the pull, or zero where the trace begins under
/// load or with fewer than five unloaded scans. A lower force is that of a coupling that pushes, which the
/// model describes. The last slip does not count: the pull may have ended in it. Empty with fewer than two
/// slips. \param sigma  noise of a scan.
[[nodiscard]] Slack find_slack(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                               double sigma);

/// Clause that says after how many slips the coupling hung slack, and that their troughs tell no K: the
/// reason why no fit is made, and why K and S − K may be absent.
/// \param slack_count  Slack::count, > 0. \param slip_count  all slips, the last included.
[[nodiscard]] std::string why_slack(std::size_t slack_count, std::size_t slip_count);

/// Sets to absent what the turning points of mostly slack slips do not tell: S − K, its scatter, and K; in a
/// ring-down S, too.
/// \param why  the reason that they get.
void void_slack_turns(const std::string& why, model::Regime regime, TestResults& results);

/// Finding kSlack; its text is why_slack() of the same counts.
[[nodiscard]] base::Finding slack_finding(std::size_t slack_count, std::size_t slip_count);

}  // namespace stickslip::analysis
