/// \file
/// Traces of a record over time, for pictures and pages.
#pragma once

#include <optional>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// Columns of equal length. A non-finite value interrupts the line.
struct RecordTrace {
  std::vector<double> time_s;  ///< After the record's first scan.
  std::vector<double> value;
};

/// Force over the sled's weight at each scan, with a break at each gap.
/// Errors: kUsage if the record has counts but no load cell, or facts that allow no calibration.
[[nodiscard]] base::Result<RecordTrace> coefficient_trace(const record::Record& record);

/// The second channel at each scan, m/s or m, with a break at each gap and each missing code. Nothing if
/// there is no second channel.
[[nodiscard]] std::optional<RecordTrace> second_trace(const record::Record& record);

/// The time derivative, by differences of neighbouring scans at the times half-way between them; Fig. 4 of
/// [Penner 1995]. \param factor  multiplies it, to convert the unit.
[[nodiscard]] RecordTrace derivative(const RecordTrace& trace, double factor);

/// g/ω₀², which turns the rate of the coefficient into the speed at which the coupling stretches: dl/dt =
/// (m g/k) dc/dt, in m. From the stiffness or the truth; absent if neither is known.
[[nodiscard]] std::optional<double> stretch_m(const record::Record& record);

}  // namespace stickslip::report
