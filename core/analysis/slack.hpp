/// \file
/// Where the coupling went slack. It pulls and cannot push: a sled that runs ahead of the belt leaves the
/// force at that of the unloaded cell. The law of a slip [2] does not hold there: it would give a force below
/// zero.
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

/// Troughs that are those of the unloaded cell.
struct Slack {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  std::size_t count = 0;  ///< Slips with such a trough.

  /// By the lowest scan: at the corner of a fall into slack an interpolated trough lies below it.
  [[nodiscard]] bool holds(const estimate::Trace& trace, const detect::Fall& slip) const noexcept;
};

/// Slips whose trough lies about the force before the pull, or about zero where the trace begins under load.
/// A force clearly below it is that of a coupling that pushes, which the model describes. The last slip does
/// not count: the pull may have ended in it. \param sigma  noise of a scan.
[[nodiscard]] Slack find_slack(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                               double sigma);

/// Why no fit of the model is made. \param slack_count > 0.
[[nodiscard]] std::string why_slack(std::size_t slack_count, std::size_t slip_count);

/// Clears K and S − K, and in a free oscillation S, where most troughs are those of a slack coupling, which
/// do not tell them. \param why  the reason that they get.
void void_slack_turns(const std::string& why, model::Regime regime, TestResults& results);

/// Code kSlack.
[[nodiscard]] base::Finding slack_finding(std::size_t slack_count, std::size_t slip_count);

}  // namespace stickslip::analysis
