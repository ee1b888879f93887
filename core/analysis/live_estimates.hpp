/// \file
/// A test as the live side saw it, slip by slip, for the estimators that fit nothing when it ends: no ω, no
/// γ, and how a slip ended is what was decided while the test ran. The scans are not looked at again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/analysis/sections.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Finds again, one slip after the other, the cycles that the live side saw.
class LiveCycles {
 public:
  /// \param trace  must outlive this, as \param cycles, in the order of time.
  LiveCycles(const estimate::Trace& trace, const base::LongColumn<detect::LiveCycle>& cycles) noexcept
      : trace_(&trace), cycles_(&cycles) {}

  /// The cycle whose peak is nearest, within half a period, and was not given before; nothing where the live
  /// side saw none there. \param slip  later than that of the call before. \param period_s  to the next; NaN
  /// if there is none.
  [[nodiscard]] std::optional<detect::LiveCycle> next_at(const detect::Fall& slip, double period_s);

 private:
  const estimate::Trace* trace_;
  const base::LongColumn<detect::LiveCycle>* cycles_;
  std::size_t next_ = 0;
};

/// What the estimators without a fit need to know beside the scans.
struct LiveSettlement {
  bool first_counts = false;  ///< The first slip counts in means.
  std::string reason;         ///< Why all else is none.
};

/// In the place of estimate_in_sections(). Of the results S, K, S − K and its scatter have values, means over
/// the slips that the live side saw, and the amplitude, half the mean drop. How a slip ended does not count
/// beside a gap, nor of the last one, in which the pull ended.
/// \param slips  of the whole test, not empty: one row for each.
[[nodiscard]] TestEstimates estimates_from_live(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips,
                                                const base::LongColumn<detect::LiveCycle>& live,
                                                const LiveSettlement& settlement,
                                                const std::filesystem::path& scratch = {});

}  // namespace stickslip::analysis
