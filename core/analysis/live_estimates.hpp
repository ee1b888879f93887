/// \file
/// Results of a test from the cycles of the live detector, by turning points.
/// They give no ω and no γ. How a slip ended is taken from the live detector; no scan is fitted again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/analysis/sections.hpp"
#include "core/analysis/slack.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Matches the slips of the whole test, one after the other, with the cycles of the live detector.
class LiveCycles {
 public:
  /// \param trace,cycles  must outlive this object; the cycles are in the order of time.
  LiveCycles(const estimate::Trace& trace, const base::LongColumn<detect::LiveCycle>& cycles) noexcept
      : trace_(&trace), cycles_(&cycles) {}

  /// The next live cycle whose peak is nearest to the slip's, closer than half a period; nullopt if there is
  /// none. Cycles that a call passes over are not returned later.
  /// \param slip  later than that of the call before.
  /// \param period_s  time to the next slip; NaN if there is none, then twice the time from peak to trough
  ///        counts.
  [[nodiscard]] std::optional<detect::LiveCycle> next_at(const detect::Fall& slip, double period_s);

 private:
  const estimate::Trace* trace_;
  const base::LongColumn<detect::LiveCycle>* cycles_;
  std::size_t next_ = 0;
};

/// Settings of estimates_from_live().
struct LiveSettlement {
  /// Means include the first slip and those after a hold. If false, the first counts only if it is alone, and
  /// those after a hold only if all others are such.
  bool first_counts = false;
  std::string reason;  ///< Reason given for all results that turning points do not determine.
  Slack slack{};  ///< Slips with such a trough, the last excepted, are not in the means of S, K and S − K.
};

/// Estimates of a test without a fit, in place of estimate_in_sections(). Values are given to S, K and S − K
/// (means over the live cycles, TierMeans::fill()), the scatter of S − K, and the amplitude (half the mean
/// drop of all slips). How a slip ended counts as unknown beside a gap, and for the last slip. The caller
/// sets rung, rung_reason and model_describes, which is left true; misfit and tester are empty.
/// \param slips  of the whole test, not empty; the result has one cycle for each.
/// \param scratch  folder for the columns of a long test; empty: memory.
[[nodiscard]] TestEstimates estimates_from_live(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips,
                                                const base::LongColumn<detect::LiveCycle>& live,
                                                const LiveSettlement& settlement,
                                                const std::filesystem::path& scratch = {});

}  // namespace stickslip::analysis
