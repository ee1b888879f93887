/// \file
/// Where the coupling went slack. It pulls and cannot push: a sled that runs ahead of the belt leaves the
/// force at that of the unloaded cell, where no slip follows [2], and with S and K a force below zero.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Fills trace.slacks, and makes the scans of slack unusable: those between the peaks of two slips within
/// four standard deviations of the unloaded level. The coupling hangs loose until the belt has caught up with
/// the sled. If the sled has come to rest before, the belt loads it anew from zero, as at the begin of a
/// pull; if not, it goes on freely with a motion that no earlier scan tells. It came to rest if the force
/// fell faster, relative to the belt's r, than the belt takes it up: with u = −ċ/r the belt catches up after
/// 2uv/(K g), and the sled stands after (1 + u) v/(K g). \param sigma  noise of a scan.
void find_slack(const base::LongColumn<detect::Fall>& slips, double sigma, estimate::Trace& trace,
                const std::filesystem::path& scratch);

/// Code kSlack; nothing without slack.
[[nodiscard]] std::optional<base::Finding> slack_finding(const estimate::Trace& trace,
                                                         std::size_t slip_count);

/// Takes away what turning points do not tell where the trough of a slip is that of a slack coupling: K and
/// S − K, and in a free oscillation S.
void void_slack_turns(const estimate::Trace& trace, model::Regime regime, TestResults& results);

}  // namespace stickslip::analysis
