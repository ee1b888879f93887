/// \file
/// A test as the live side saw it, slip by slip, for the estimators that fit nothing when it ends: no ω, no
/// γ, and how a slip ended is what was decided while the test ran. The scans are not looked at again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/long_column.hpp"
#include "core/friction/cycle.hpp"
#include "core/friction/fall_finder.hpp"
#include "core/friction/sections.hpp"
#include "core/friction/trace.hpp"

namespace stickslip::friction {

/// Finds again, one slip after the other, the cycles that the live side saw.
class LiveCycles {
 public:
  /// \param trace  must outlive this, as \param cycles, in the order of time.
  LiveCycles(const Trace& trace, const base::LongColumn<Cycle>& cycles) noexcept
      : trace_(&trace), cycles_(&cycles) {}

  /// The cycle whose peak is nearest, within half a period, and was not given before; nothing where the live
  /// side saw none there. \param slip  later than that of the call before. \param period_s  to the next; NaN
  /// if there is none.
  [[nodiscard]] std::optional<Cycle> next_at(const Fall& slip, double period_s);

 private:
  const Trace* trace_;
  const base::LongColumn<Cycle>* cycles_;
  std::size_t next_ = 0;
};

/// In the place of estimate_in_sections(). Of the results only the amplitude has a value, half the mean drop.
/// \param slips  of the whole test, not empty: one row for each.
/// \param live  with what was known in the end of each one's capture as capture_evidence.
/// \param describes  the evidence rests on the model; else only a unanimous vote on the regime counts.
/// \param reason  why the other results are none.
[[nodiscard]] TestEstimates estimates_from_live(const Trace& trace, const base::LongColumn<Fall>& slips,
                                                const base::LongColumn<Cycle>& live, bool describes,
                                                const std::string& reason,
                                                const std::filesystem::path& scratch = {});

}  // namespace stickslip::friction
